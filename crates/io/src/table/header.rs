//! Names in the header of a table, and what they are apart from how people write them.

/// A column name without what people write differently.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(|letter| !matches!(letter, ' ' | '_' | '-')).flat_map(char::to_lowercase).collect()
}

/// A column name without its unit and without what people write differently.
pub(super) fn unbracketed(name: &str) -> String {
    plain(name.split(['[', '(']).next().unwrap_or_default())
}

/// The same, and without the distance that CellProfiler adds to the name of its tracks.
pub(super) fn bare(name: &str) -> String {
    let name = unbracketed(name);
    let tracks = name.strip_prefix("trackobjectslabel");
    match tracks.is_some_and(|rest| rest.bytes().all(|byte| byte.is_ascii_digit())) {
        true => "trackobjectslabel".into(),
        false => name,
    }
}

/// The unit in brackets at the end of a name.
pub(super) fn unit_in(name: &str) -> Option<String> {
    let start = name.find(['[', '('])? + 1;
    let unit = name[start..].trim_end_matches([']', ')']).trim();
    (!unit.is_empty()).then(|| unit.to_owned())
}
