//! The masks in what Cellpose saves: a pickled dictionary of arrays.

use std::path::Path;

use ndarray::ArrayD;

use crate::array::integers_of;
use crate::error::{Error, ImageFault, excerpt, image_error};
use crate::pickle::{Id, Node, Pickle};

/// The masks of a `_seg.npy`, from the bytes that follow the header of the array; `path` only names the place.
pub(crate) fn read_masks(path: &Path, body: &[u8]) -> Result<ArrayD<i64>, Error> {
    let failure = |fault| image_error(path, fault);
    let pickle = Pickle::parse(body).map_err(|detail| failure(ImageFault::Pickled { detail }))?;
    let dictionary = dictionary_of(&pickle)
        .ok_or_else(|| failure(ImageFault::Pickled { detail: "it is no dictionary".into() }))?;
    let masks = pickle
        .entry(dictionary, "masks")
        .ok_or_else(|| failure(ImageFault::NoMasks { found: names(&pickle, dictionary) }))?;
    let array = array_of(&pickle, masks)
        .ok_or_else(|| failure(ImageFault::Pickled { detail: "its masks are no array of NumPy".into() }))?;
    integers_of(&array.item, array.shape, array.fortran_order, array.body)
        .map_err(|fault| Error::Format { path: path.to_path_buf(), fault })
}

/// The dictionary, whether it is by itself or in an array of one object, as `numpy.save` puts it.
fn dictionary_of(pickle: &Pickle<'_>) -> Option<Id> {
    let root = pickle.root();
    match pickle.node(root) {
        Node::Dictionary(_) => Some(root),
        Node::Object { state: Some(state), .. } => {
            let objects = pickle.sequence(*pickle.sequence(*state)?.get(4)?)?;
            objects.iter().copied().find(|id| matches!(pickle.node(*id), Node::Dictionary(_)))
        }
        // The object of an array of no dimensions, as numpy.save writes it.
        Node::Sequence(objects) => {
            objects.iter().copied().find(|id| matches!(pickle.node(*id), Node::Dictionary(_)))
        }
        _ => None,
    }
}

/// The keys of a dictionary, as far as they are text.
fn names(pickle: &Pickle<'_>, dictionary: Id) -> String {
    let Node::Dictionary(entries) = pickle.node(dictionary) else { return String::new() };
    let names = entries.iter().filter_map(|(key, _)| match pickle.node(*key) {
        Node::Text(name) => Some(excerpt(name)),
        _ => None,
    });
    names.take(10).collect::<Vec<_>>().join(", ")
}

/// An array as it is pickled.
struct Pickled<'a> {
    /// The type of its elements, such as `<u2`.
    item: String,
    shape: Vec<usize>,
    fortran_order: bool,
    body: &'a [u8],
}

fn array_of<'a>(pickle: &Pickle<'a>, id: Id) -> Option<Pickled<'a>> {
    let Node::Object { class, arguments, state } = pickle.node(id) else { return None };
    let &Node::Global(module, name) = pickle.node(*class) else { return None };
    if !module.starts_with("numpy") {
        return None;
    }
    // Protocols up to 4 make an empty array and then give it its state; protocol 5 makes it from its bytes.
    let (shape, item, is_fortran, body) = match (name, state) {
        ("_reconstruct", Some(state)) => match *pickle.sequence(*state)? {
            [_, shape, item, is_fortran, body] => {
                (shape, item, *pickle.node(is_fortran) == Node::Flag(true), body)
            }
            _ => return None,
        },
        ("_frombuffer", _) => match *pickle.sequence(*arguments)? {
            [body, item, shape, order] => (shape, item, *pickle.node(order) == Node::Text("F"), body),
            _ => return None,
        },
        _ => return None,
    };
    let shape = pickle.sequence(shape)?.iter().map(|length| match pickle.node(*length) {
        Node::Integer(length) => usize::try_from(*length).ok(),
        _ => None,
    });
    let &Node::Bytes(body) = pickle.node(body) else { return None };
    Some(Pickled {
        item: item_of(pickle, item)?,
        shape: shape.collect::<Option<_>>()?,
        fortran_order: is_fortran,
        body,
    })
}

/// The type of elements: `numpy.dtype("u2")`, whose state begins with a version and the order of bytes.
fn item_of(pickle: &Pickle<'_>, id: Id) -> Option<String> {
    let Node::Object { arguments, state, .. } = pickle.node(id) else { return None };
    let &Node::Text(name) = pickle.node(*pickle.sequence(*arguments)?.first()?) else { return None };
    let order = state.and_then(|state| match pickle.node(*pickle.sequence(state)?.get(1)?) {
        Node::Text(order @ ("<" | ">" | "|")) => Some(*order),
        _ => None,
    });
    Some(format!("{}{name}", order.unwrap_or("|")))
}
