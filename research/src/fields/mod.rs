//! Tables of the fields of `report.json` in the pages of commands, made from what `voronudge schema` says: types and
//! documentation of the fields as they are declared.
//!
//! A table stands between `<!-- fields: infer -->` and `<!-- end of fields -->`. Of several commands, with commas between
//! them, the fields must be the same. `every report` stands for the fields that all reports have, which other tables leave out;
//! `discover beside infer` refers to the table of `infer` for what is declared once for both.

mod table;

use crate::{Outcome, program};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;
use table::Table;
use xtask::pages::{Pages, anchor};

const BEGIN: &str = "<!-- fields: ";
const END: &str = "<!-- end of fields -->";
/// Stands for the fields of all reports.
const EVERY: &str = "every report";

/// Writes the tables of all pages; reports without a table are an error.
pub fn run(root: &Path) -> Outcome {
    let Declared { changed, missing } = Declared::read(root)?;
    for (page, text) in changed {
        fs::write(root.join(&page), text)?;
        println!("{} written", page.display());
    }
    match missing.first() {
        Some(name) => Err(without_table(name).into()),
        None => Ok(()),
    }
}

fn without_table(command: &str) -> String {
    format!("no page has the fields of {command}: `{BEGIN}{command} -->`, `{END}`")
}

/// Pages whose tables are not what the types say, and reports without a table.
#[cfg(test)]
fn violations(root: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let Declared { changed, missing } = Declared::read(root)?;
    let page = |page: &PathBuf| {
        format!("{}: tables of fields are not what the types say; cargo xtask fields", page.display())
    };
    Ok(changed.keys().map(page).chain(missing.iter().map(|name| without_table(name))).collect())
}

/// Pages as they should be.
struct Declared {
    /// Those that differ.
    changed: BTreeMap<PathBuf, String>,
    /// Commands without a table.
    missing: BTreeSet<String>,
}

impl Declared {
    fn read(root: &Path) -> Result<Self, Box<dyn Error>> {
        let schemas = Schemas::ask(root)?;
        let pages = Pages::read(root)?.texts;
        let mut homes = BTreeMap::new();
        for (page, text) in &pages {
            for block in blocks(text)? {
                let heading = text[..block.begin].lines().rev().find_map(|line| line.strip_prefix("## "));
                let link = format!("{}#{}", page.display(), anchor(heading.unwrap_or_default()));
                homes.extend(block.commands.iter().map(|name| ((*name).to_owned(), link.clone())));
            }
        }
        let mut changed = BTreeMap::new();
        for (page, text) in &pages {
            let mut new = String::new();
            let mut done = 0;
            for Block { commands, beside, begin, end } in blocks(text)? {
                let home = |name| homes.get(name).ok_or(format!("{}: no table of {name}", page.display()));
                // Pages of commands are in one folder.
                let link = beside.map(home).transpose()?.and_then(|home| home.rsplit('/').next());
                let table = schemas.table(&commands, beside.zip(link))?;
                new += &text[done..begin];
                new += &table;
                done = end;
            }
            new += &text[done..];
            if new != *text {
                changed.insert(page.clone(), new);
            }
        }
        let missing = schemas.of.keys().filter(|name| !homes.contains_key(*name)).cloned();
        Ok(Self { changed, missing: missing.collect() })
    }
}

/// A table in a page.
struct Block<'a> {
    commands: Vec<&'a str>,
    /// Another command, to whose table this one refers.
    beside: Option<&'a str>,
    /// Where its lines are.
    begin: usize,
    end: usize,
}

/// The tables of a page.
fn blocks(text: &str) -> Result<Vec<Block<'_>>, String> {
    let mut found = Vec::new();
    for (place, _) in text.match_indices(BEGIN).filter(|(place, _)| text[..*place].ends_with('\n')) {
        let rest = &text[place + BEGIN.len()..];
        let (name, table) = rest.split_once(" -->\n").ok_or(format!("{BEGIN}without its end"))?;
        let begin = text.len() - table.len();
        let end = begin + table.find(END).ok_or(format!("{BEGIN}{name} --> without {END}"))?;
        let (names, beside) =
            name.split_once(" beside ").map_or((name, None), |(own, other)| (own, Some(other)));
        found.push(Block { commands: names.split(", ").collect(), beside, begin, end });
    }
    Ok(found)
}

/// What the program says of each report.
struct Schemas {
    of: BTreeMap<String, Value>,
}

impl Schemas {
    fn ask(root: &Path) -> Result<Self, Box<dyn Error>> {
        let program = program::path()?;
        is_new(&program, root)?;
        let ask = |words: &str| -> Result<String, Box<dyn Error>> {
            let output = Command::new(&program).arg("schema").args(words.split_whitespace()).output()?;
            Ok(String::from_utf8(output.stdout)?)
        };
        let schema = |name: &str| Ok((name.to_owned(), serde_json::from_str(&ask(name)?)?));
        Ok(Self { of: ask("")?.lines().map(schema).collect::<Result<_, Box<dyn Error>>>()? })
    }

    /// The schema of a command.
    fn schema(&self, name: &str) -> Result<&Value, String> {
        self.of.get(name).ok_or_else(|| format!("{name}: no command of this name writes a report.json"))
    }

    /// Those of runs, which what info prints is none of.
    fn records(&self) -> impl Iterator<Item = &Value> {
        self.of.values().filter(|schema| schema["properties"]["command_line"].is_object())
    }

    /// The fields that all records have.
    fn of_every_report(&self) -> Map<String, Value> {
        let first = self.records().next().and_then(|schema| schema["properties"].as_object());
        let mut every = first.cloned().unwrap_or_default();
        // The name of the command is another in each.
        every.values_mut().filter_map(Value::as_object_mut).for_each(|field| drop(field.remove("const")));
        for schema in self.records() {
            every.retain(|name, field| schema["properties"][name]["description"] == field["description"]);
        }
        every
    }

    /// The table of commands whose reports are alike, beside that of another one with a link to it.
    fn table(&self, commands: &[&str], beside: Option<(&str, &str)>) -> Result<String, String> {
        let every = self.of_every_report();
        if commands == [EVERY] {
            let mut schema = self.records().next().cloned().unwrap_or_default();
            schema["properties"] = every.into();
            return Ok(Table::new(&schema).written(&schema));
        }
        let own = |name: &&str| -> Result<Value, String> {
            let mut schema = self.schema(name)?.clone();
            if schema["properties"]["command_line"].is_object()
                && let Some(fields) = schema["properties"].as_object_mut()
            {
                fields.retain(|name, _| !every.contains_key(name));
            }
            Ok(schema)
        };
        let mut texts = Vec::new();
        for name in commands {
            let schema = own(name)?;
            let mut table = Table::new(&schema);
            if let Some((other, link)) = beside {
                let other_schema = own(&other)?;
                let mut known = Table::new(&other_schema);
                known.written(&other_schema);
                for (definition, path) in known.shown {
                    if known.definitions[&definition] == table.definitions[&definition] {
                        table.shown.insert(definition, format!("[{path} of {other}]({link})"));
                    }
                }
            }
            texts.push(table.written(&schema));
        }
        texts.dedup();
        match texts.as_slice() {
            [table] => Ok(table.clone()),
            _ => Err(format!("{}: their fields differ", commands.join(", "))),
        }
    }
}

/// Asserts that a program is newer than all that it is made of, which cargo lists beside it; there is no list where it was built for tests.
fn is_new(program: &Path, root: &Path) -> Outcome {
    let made = fs::metadata(program)?.modified()?;
    let list = match fs::read_to_string(program.with_extension("d")) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        list => list?,
    };
    for file in list.split_whitespace().skip(1).filter(|file| Path::new(file).starts_with(root)) {
        if fs::metadata(file).and_then(|data| data.modified()).is_ok_and(|changed| changed > made) {
            return Err(format!("{} is older than {file}: build it first", program.display()).into());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn schemas() -> Schemas {
        let error = json!({
            "type": "object",
            "properties": { "value": { "type": ["number", "null"], "description": "The |value|." } },
            "required": ["value"],
        });
        let own = json!({
            "properties": {
                "command_line": { "type": "string", "description": "As typed." },
                "at": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "integer" }, "description": "Where." },
                "first": { "type": "array", "items": { "$ref": "#/$defs/Error" }, "description": "Errors." },
                "second": { "anyOf": [{ "$ref": "#/$defs/Error" }, { "type": "null" }], "description": "Another\none.\n\nAt length." },
                "third": { "type": "object", "additionalProperties": { "$ref": "#/$defs/Error" }, "description": "By name." },
                "how": { "oneOf": [
                    { "type": "string", "const": "well", "description": "Without a fault." },
                    { "type": "object", "properties": { "ill": { "enum": ["a", "b"] } }, "description": "With one." },
                ], "description": "How." },
            },
            "required": ["command_line", "second", "first", "third", "how"],
            "$defs": { "Error": error.clone() },
        });
        let other = json!({
            "properties": {
                "command_line": { "type": "string", "description": "As typed." },
                "last": { "$ref": "#/$defs/Error", "description": "The last." },
            },
            "required": ["command_line", "last"],
            "$defs": { "Error": error },
        });
        Schemas { of: [("own".to_owned(), own), ("other".to_owned(), other)].into() }
    }

    /// By the program as the tests built it.
    #[test]
    fn tables_of_pages_are_what_the_types_say() {
        assert_eq!(violations(&crate::root()).unwrap(), Vec::<String>::new());
    }

    #[test]
    fn fields_are_told_in_their_order_and_each_type_once() {
        let table = schemas().table(&["own"], None).unwrap();
        assert_eq!(
            table.lines().skip(2).collect::<Vec<_>>(),
            [
                "| `second` | object or `null` | Another one. |",
                "| `second.value` | number | The \\|value\\|. |",
                "| `first` | list of objects as `second` | Errors. |",
                "| `third` | objects as `second` by name | By name. |",
                "| `how` | text or object | How. `well`: Without a fault. |",
                "| `how.ill` | one of `a`, `b`, may be missing | With one. |",
                "| `at` | 2 whole numbers, may be missing | Where. |",
            ]
        );
    }

    #[test]
    fn what_all_reports_have_is_told_once_and_tables_refer_to_others() {
        let schemas = schemas();
        let rows = |commands: &[&str], beside| {
            let table = schemas.table(commands, beside).unwrap();
            table.lines().skip(2).map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(rows(&[EVERY], None), ["| `command_line` | text | As typed. |"]);
        assert_eq!(
            rows(&["other"], Some(("own", "own.md#fields"))),
            ["| `last` | object as [`second` of own](own.md#fields) | The last. |"]
        );
        assert!(schemas.table(&["own", "other"], None).is_err());
        assert!(schemas.table(&["none"], None).is_err());
    }

    #[test]
    fn tables_are_found_by_their_lines() {
        let text = "# a\n\n<!-- fields: a, b c beside d -->\nold\n<!-- end of fields -->\nand `<!-- fields: no -->`\n";
        let [block] = blocks(text).unwrap().try_into().ok().unwrap();
        assert_eq!((block.commands, block.beside), (vec!["a", "b c"], Some("d")));
        assert_eq!(&text[block.begin..block.end], "old\n");
        assert!(blocks("\n<!-- fields: a -->\n").is_err());
    }
}
