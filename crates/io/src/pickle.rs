//! Pickled Python objects as far as NumPy writes them: data only, nothing is ever called.
//!
//! The instructions of protocols 2 to 5 that build numbers, texts, bytes, lists, tuples and dictionaries are followed. Objects of classes
//! become [`Node::Object`], which keeps the name of the class, the arguments and the state. All values lie in one list and refer to each
//! other by number, so values that are used again are not copied and no depth of nesting costs anything.

/// The most values of a file. Those of Cellpose have some hundreds, and one for each outline where these were drawn by hand.
const MOST_NODES: usize = 10_000_000;

/// Index of a value.
pub(crate) type Id = usize;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Node<'a> {
    Nothing,
    Flag(bool),
    Integer(i64),
    Real,
    Text(&'a str),
    Bytes(&'a [u8]),
    /// A tuple or a list.
    Sequence(Vec<Id>),
    Dictionary(Vec<(Id, Id)>),
    /// Module and name of a class or a function.
    Global(&'a str, &'a str),
    /// What calling a class would give, and the state that it would then be given.
    Object {
        class: Id,
        arguments: Id,
        state: Option<Id>,
    },
}

/// The values of a file.
#[derive(Debug)]
pub(crate) struct Pickle<'a> {
    nodes: Vec<Node<'a>>,
    root: Id,
}

impl<'a> Pickle<'a> {
    /// Follows the instructions; what is wrong, in a few words, where that is not possible.
    pub(crate) fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let mut machine = Machine {
            bytes,
            at: 0,
            nodes: Vec::new(),
            stack: Vec::new(),
            marks: Vec::new(),
            memo: Vec::new(),
        };
        let root = machine.run()?;
        Ok(Self { nodes: machine.nodes, root })
    }

    pub(crate) fn root(&self) -> Id {
        self.root
    }

    pub(crate) fn node(&self, id: Id) -> &Node<'a> {
        self.nodes.get(id).unwrap_or(&Node::Nothing)
    }

    /// The values of a tuple or a list.
    pub(crate) fn sequence(&self, id: Id) -> Option<&[Id]> {
        match self.node(id) {
            Node::Sequence(items) => Some(items),
            _ => None,
        }
    }

    /// The value of a dictionary under a text.
    pub(crate) fn entry(&self, id: Id, key: &str) -> Option<Id> {
        let Node::Dictionary(entries) = self.node(id) else { return None };
        entries.iter().rev().find(|(name, _)| *self.node(*name) == Node::Text(key)).map(|(_, value)| *value)
    }
}

struct Machine<'a> {
    bytes: &'a [u8],
    at: usize,
    nodes: Vec<Node<'a>>,
    stack: Vec<Id>,
    /// Heights of the stack.
    marks: Vec<usize>,
    memo: Vec<Option<Id>>,
}

impl<'a> Machine<'a> {
    fn run(&mut self) -> Result<Id, String> {
        loop {
            let place = self.at;
            match self.byte()? {
                b'.' => return self.pop(),
                // Protocol and frames.
                0x80 => self.skip(1)?,
                0x95 => self.skip(8)?,
                b'(' => self.marks.push(self.stack.len()),
                b'N' => self.push(Node::Nothing)?,
                0x88 => self.push(Node::Flag(true))?,
                0x89 => self.push(Node::Flag(false))?,
                b'K' => self.integer(1)?,
                b'M' => self.integer(2)?,
                b'J' => {
                    let value = self.length(4)? as u32;
                    self.push(Node::Integer(i64::from(value as i32)))?;
                }
                0x8a => self.long()?,
                b'G' => {
                    self.skip(8)?;
                    self.push(Node::Real)?;
                }
                0x8c => self.text(1)?,
                b'X' => self.text(4)?,
                0x8d => self.text(8)?,
                b'C' | b'U' => self.byte_string(1)?,
                b'B' | b'T' => self.byte_string(4)?,
                0x8e | 0x96 => self.byte_string(8)?,
                b']' | b')' => self.push(Node::Sequence(Vec::new()))?,
                b'}' => self.push(Node::Dictionary(Vec::new()))?,
                0x85 => self.tuple(1)?,
                0x86 => self.tuple(2)?,
                0x87 => self.tuple(3)?,
                b't' | b'l' => {
                    let items = self.since_mark()?;
                    self.push(Node::Sequence(items))?;
                }
                b'a' => {
                    let item = self.pop()?;
                    self.extend(vec![item])?;
                }
                b'e' => {
                    let items = self.since_mark()?;
                    self.extend(items)?;
                }
                b's' => {
                    let (value, key) = (self.pop()?, self.pop()?);
                    self.insert(&[key, value])?;
                }
                b'u' => {
                    let items = self.since_mark()?;
                    self.insert(&items)?;
                }
                b'c' => {
                    let (module, name) = (self.line()?, self.line()?);
                    self.push(Node::Global(module, name))?;
                }
                0x93 => {
                    let (name, module) = (self.pop()?, self.pop()?);
                    let (Node::Text(module), Node::Text(name)) = (&self.nodes[module], &self.nodes[name])
                    else {
                        return Err(format!("no name of a class at byte {place}"));
                    };
                    let global = Node::Global(module, name);
                    self.push(global)?;
                }
                b'R' | 0x81 => {
                    let (arguments, class) = (self.pop()?, self.pop()?);
                    self.push(Node::Object { class, arguments, state: None })?;
                }
                b'b' => {
                    let (new, object) = (self.pop()?, self.top()?);
                    if let Node::Object { state, .. } = &mut self.nodes[object] {
                        *state = Some(new);
                    }
                }
                b'0' => {
                    self.pop()?;
                }
                b'1' => {
                    self.since_mark()?;
                }
                b'q' => self.remember(1)?,
                b'r' => self.remember(4)?,
                0x94 => {
                    let top = self.top()?;
                    self.memo.push(Some(top));
                }
                b'h' => self.recall(1)?,
                b'j' => self.recall(4)?,
                other => return Err(format!("instruction {other} at byte {place} is not known")),
            }
        }
    }

    fn take(&mut self, length: u64) -> Result<&'a [u8], String> {
        let end = usize::try_from(length).ok().and_then(|length| self.at.checked_add(length));
        let part = end.and_then(|end| self.bytes.get(self.at..end)).ok_or("it ends too early")?;
        self.at += part.len();
        Ok(part)
    }

    fn skip(&mut self, length: u64) -> Result<(), String> {
        self.take(length).map(|_| ())
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// An unsigned number of so many bytes.
    fn length(&mut self, bytes: u64) -> Result<u64, String> {
        Ok(self.take(bytes)?.iter().rev().fold(0, |number, byte| (number << 8) | u64::from(*byte)))
    }

    fn line(&mut self) -> Result<&'a str, String> {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|byte| *byte == b'\n').ok_or("it ends too early")?;
        self.at += end + 1;
        std::str::from_utf8(&rest[..end]).map_err(|_| "a name is not text".into())
    }

    fn push(&mut self, node: Node<'a>) -> Result<(), String> {
        if self.nodes.len() == MOST_NODES {
            return Err(format!("more than {MOST_NODES} values"));
        }
        self.stack.push(self.nodes.len());
        self.nodes.push(node);
        Ok(())
    }

    fn top(&self) -> Result<Id, String> {
        self.stack.last().copied().ok_or_else(|| "a value is missing".into())
    }

    fn pop(&mut self) -> Result<Id, String> {
        let top = self.top()?;
        self.stack.pop();
        Ok(top)
    }

    fn since_mark(&mut self) -> Result<Vec<Id>, String> {
        let mark = self.marks.pop().filter(|mark| *mark <= self.stack.len()).ok_or("a mark is missing")?;
        Ok(self.stack.split_off(mark))
    }

    fn integer(&mut self, bytes: u64) -> Result<(), String> {
        let value = self.length(bytes)?;
        self.push(Node::Integer(value as i64))
    }

    /// A signed number of any length; those beyond 64 bits are no shape of an array.
    fn long(&mut self) -> Result<(), String> {
        let length = self.length(1)?;
        let digits = self.take(length)?;
        let sign = digits.last().map_or(0, |last| if last & 0x80 == 0 { 0 } else { -1_i64 });
        if digits.len() > 8 {
            return self.push(Node::Nothing);
        }
        let value = digits.iter().rev().fold(sign, |number, byte| (number << 8) | i64::from(*byte));
        self.push(Node::Integer(value))
    }

    fn text(&mut self, bytes: u64) -> Result<(), String> {
        let length = self.length(bytes)?;
        let text = std::str::from_utf8(self.take(length)?).unwrap_or("");
        self.push(Node::Text(text))
    }

    fn byte_string(&mut self, bytes: u64) -> Result<(), String> {
        let length = self.length(bytes)?;
        let part = self.take(length)?;
        self.push(Node::Bytes(part))
    }

    fn tuple(&mut self, length: usize) -> Result<(), String> {
        let start = self.stack.len().checked_sub(length).ok_or("a value is missing")?;
        let items = self.stack.split_off(start);
        self.push(Node::Sequence(items))
    }

    fn extend(&mut self, items: Vec<Id>) -> Result<(), String> {
        let list = self.top()?;
        match &mut self.nodes[list] {
            Node::Sequence(own) => own.extend(items),
            Node::Object { .. } => {}
            _ => return Err("values are added to what is no list".into()),
        }
        Ok(())
    }

    fn insert(&mut self, items: &[Id]) -> Result<(), String> {
        let dictionary = self.top()?;
        match &mut self.nodes[dictionary] {
            Node::Dictionary(own) => own.extend(items.chunks_exact(2).map(|pair| (pair[0], pair[1]))),
            Node::Object { .. } => {}
            _ => return Err("values are added to what is no dictionary".into()),
        }
        Ok(())
    }

    fn remember(&mut self, bytes: u64) -> Result<(), String> {
        let (place, top) = (self.length(bytes)? as usize, self.top()?);
        // Places are given out one after the other.
        if place > self.bytes.len() {
            return Err("a place in memory is beyond the file".into());
        }
        if place >= self.memo.len() {
            self.memo.resize(place + 1, None);
        }
        self.memo[place] = Some(top);
        Ok(())
    }

    fn recall(&mut self, bytes: u64) -> Result<(), String> {
        let place = self.length(bytes)? as usize;
        let id = self.memo.get(place).copied().flatten().ok_or("a value is missing from memory")?;
        self.stack.push(id);
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail anywhere")]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_and_used_again() {
        // pickle.dumps({"a": [1, -2, 300, None], "b": (True, b"xy")}, protocol=4)
        let bytes = b"\x80\x04\x95(\x00\x00\x00\x00\x00\x00\x00}\x94(\x8c\x01a\x94]\x94(K\x01J\xfe\xff\xff\xffM,\x01Ne\x8c\x01b\x94\x88C\x02xy\x94\x86\x94u.";
        let pickle = Pickle::parse(bytes).unwrap();
        let list = pickle.sequence(pickle.entry(pickle.root(), "a").unwrap()).unwrap();
        let numbers: Vec<_> = list.iter().map(|id| pickle.node(*id).clone()).collect();
        assert_eq!(numbers, [Node::Integer(1), Node::Integer(-2), Node::Integer(300), Node::Nothing]);
        let pair = pickle.sequence(pickle.entry(pickle.root(), "b").unwrap()).unwrap();
        assert_eq!(pickle.node(pair[1]), &Node::Bytes(b"xy"));
        assert_eq!(pickle.entry(pickle.root(), "c"), None);
    }

    #[test]
    fn nothing_is_called_and_nothing_unfolds() {
        // os.system("true"): an object that nobody makes.
        let call = Pickle::parse(b"\x80\x02cos\nsystem\nX\x04\x00\x00\x00true\x85R.").unwrap();
        let Node::Object { class, .. } = call.node(call.root()) else { unreachable!() };
        assert_eq!(call.node(*class), &Node::Global("os", "system"));
        // Each list holds the one before ten times: 10^30 values if they were copied.
        let mut bytes = b"\x80\x04]".to_vec();
        for place in 0..30_u8 {
            bytes.extend([b'q', place, b'0', b']', b'(']);
            bytes.extend([b'h', place].repeat(10));
            bytes.push(b'e');
        }
        bytes.push(b'.');
        assert!(Pickle::parse(&bytes).unwrap().nodes.len() < 100);
        // A million lists in each other.
        let mut bytes = vec![b']'; 1_000_000];
        bytes.extend(vec![b'a'; 999_999]);
        bytes.push(b'.');
        assert!(Pickle::parse(&bytes).is_ok());
    }

    #[test]
    fn what_is_cut_or_unknown_is_told() {
        for (bytes, fact) in [
            (&b""[..], "ends too early"),
            (b"\x80\x04B\xff\xff\xff\x7f", "ends too early"),
            (b"\x8e\xff\xff\xff\xff\xff\xff\xff\xff", "ends too early"),
            (b"h\x05.", "missing from memory"),
            (b"r\xff\xff\xff\xff", "a value is missing"),
            (b"Nr\xff\xff\xff\xff", "beyond the file"),
            (b"e", "a mark is missing"),
            (b"NNa.", "no list"),
            (b".", "a value is missing"),
            (b"\x01", "instruction 1 at byte 0"),
        ] {
            let fault = Pickle::parse(bytes).unwrap_err();
            assert!(fault.contains(fact), "{fact}: {fault}");
        }
    }
}
