//! The list of what pages quote, `docs/quotes.toml`.

use super::expression;
use super::number::{self, Printed};
use super::page;
use serde::Deserialize;
use std::error::Error;
use std::path::{Path, PathBuf};
use xtask::pages::Pages;

/// Where it stands, from the root.
pub const PATH: &str = "docs/quotes.toml";

/// What is quoted, and how to come by it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct List {
    /// Names of files and folders that a reader brings.
    pub brought: Vec<String>,
    /// Files whose content a page shows.
    #[serde(default)]
    pub file: Vec<Shown>,
    /// Consoles that are not run, or take long.
    #[serde(default)]
    pub console: Vec<Console>,
    /// Commands, and what pages have of them.
    #[serde(default)]
    pub run: Vec<Run>,
}

/// A file that a page shows.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shown {
    pub page: PathBuf,
    pub name: String,
    /// A line of the block that is its content.
    pub line: String,
    /// Text of it that is replaced, and by what.
    #[serde(default)]
    pub replaced: Option<[String; 2]>,
}

/// What is known of a console before it is run.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Console {
    pub page: PathBuf,
    /// First of its commands.
    pub command: String,
    /// Why it is never run.
    #[serde(default)]
    pub because: Option<String>,
    /// Processor time that it takes.
    #[serde(default)]
    pub seconds: f64,
}

/// Commands, run in order in a folder of their own.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Where the quotes stand that do not say.
    pub page: PathBuf,
    pub commands: Vec<String>,
    /// Processor time that they take, if it is near a minute or more.
    #[serde(default)]
    pub seconds: f64,
    #[serde(default)]
    pub quote: Vec<Quote>,
    #[serde(default)]
    pub block: Vec<Copied>,
    /// Figures of the gallery that the last command makes.
    #[serde(default)]
    pub figure: Vec<String>,
}

/// Words of a page with numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quote {
    #[serde(default)]
    page: Option<PathBuf>,
    /// As they stand there, with braces around each number that is compared. Without any, the last command prints these very words.
    pub words: String,
    /// Where each number comes from.
    #[serde(default)]
    pub from: Vec<String>,
}

/// A block of a page that is what the last command prints.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Copied {
    #[serde(default)]
    page: Option<PathBuf>,
    /// A line of it, and of no other.
    pub line: String,
    /// A file that it is a copy of instead.
    #[serde(default)]
    pub file: Option<String>,
}

/// How a number of a page and the one that came out are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Relation {
    /// Equal after rounding to what is printed.
    Rounded,
    /// Not farther apart than this.
    Within(f64),
    /// What came out is not above that of the page.
    AtMost,
    /// Nor below.
    AtLeast,
}

impl Run {
    /// Its commands in a line, all but the first and the last left out.
    pub fn told(&self) -> String {
        match &self.commands[..] {
            [first, .., last] if self.commands.len() > 2 => format!("{first}; …; {last}"),
            commands => commands.join("; "),
        }
    }

    /// The pages that quote it.
    pub fn pages(&self) -> impl Iterator<Item = &Path> {
        let quotes = self.quote.iter().map(|quote| quote.page(self));
        let blocks = self.block.iter().map(|block| block.page(self));
        quotes.chain(blocks).chain(self.figure.iter().map(|_| self.page.as_path()))
    }
}

impl Quote {
    pub fn page<'a>(&'a self, run: &'a Run) -> &'a Path {
        self.page.as_deref().unwrap_or(&run.page)
    }

    /// The words without braces.
    pub fn plain(&self) -> String {
        self.words.replace(['{', '}'], "")
    }

    /// The numbers between braces.
    pub fn numbers(&self) -> Vec<(&str, Option<Printed>)> {
        let between = self.words.split('{').skip(1).filter_map(|rest| rest.split_once('}'));
        between.map(|(text, _)| (text, number::parse(text))).collect()
    }
}

impl Copied {
    pub fn page<'a>(&'a self, run: &'a Run) -> &'a Path {
        self.page.as_deref().unwrap_or(&run.page)
    }
}

impl Relation {
    /// What an entry of `from` begins with, and the expression after it.
    pub fn split(from: &str) -> Result<(Self, &str), String> {
        if let Some(rest) = from.strip_prefix("at most ") {
            Ok((Self::AtMost, rest))
        } else if let Some(rest) = from.strip_prefix("at least ") {
            Ok((Self::AtLeast, rest))
        } else if let Some(rest) = from.strip_prefix("within ") {
            let (width, rest) =
                rest.split_once(" of ").ok_or_else(|| format!("{from}: \" of \" is missing"))?;
            let width = width.parse().map_err(|_| format!("{from}: \"{width}\" is no number"))?;
            Ok((Self::Within(width), rest))
        } else {
            Ok((Self::Rounded, from))
        }
    }

    pub fn holds(self, printed: Printed, value: f64) -> bool {
        match self {
            Self::Rounded => printed.is_rounded(value),
            Self::Within(width) => (value - printed.value).abs() <= width,
            Self::AtMost => value <= printed.value,
            Self::AtLeast => value >= printed.value,
        }
    }
}

impl List {
    pub fn read(root: &Path) -> Result<Self, Box<dyn Error>> {
        let path = root.join(PATH);
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(toml::from_str(&text).map_err(|error| format!("{PATH}: {error}"))?)
    }

    /// What is said of a console of a page.
    pub fn said_of(&self, page: &Path, command: &str) -> Option<&Console> {
        self.console.iter().find(|own| own.page == page && own.command == command)
    }

    /// Entries that do not belong to the pages.
    pub fn faults(&self, pages: &Pages) -> Vec<String> {
        let mut found = Vec::new();
        for own in &self.console {
            let text = text_of(pages, &own.page);
            let begins = |block: &&page::Block<'_>| {
                block.typed().first().is_some_and(|typed| typed.command == own.command)
            };
            let count = page::blocks(text).iter().filter(begins).count();
            if count != 1 {
                found.push(format!("{}: {count} consoles begin with {}", own.page.display(), own.command));
            }
        }
        for own in &self.file {
            found.extend(block_of(pages, &own.page, &own.line).err());
        }
        for run in &self.run {
            if run.commands.is_empty() || run.pages().next().is_none() {
                found.push(format!(
                    "{}: a run without commands, or of which nothing is quoted",
                    run.page.display()
                ));
            }
            found.extend(run.block.iter().filter_map(|own| block_of(pages, own.page(run), &own.line).err()));
            for quote in &run.quote {
                found.extend(
                    quote.fault(text_of(pages, quote.page(run))).map(|fault| {
                        format!("{}: \"{}\": {fault}", quote.page(run).display(), quote.plain())
                    }),
                );
            }
        }
        found
    }
}

impl Quote {
    fn fault(&self, text: &str) -> Option<String> {
        let times = page::places(text, &self.plain()).len();
        let numbers = self.numbers();
        let unread = numbers.iter().find(|(_, number)| number.is_none());
        if times != 1 {
            Some(format!("stands there {times} times, and should once"))
        } else if let Some((text, _)) = unread {
            Some(format!("{text} is no number"))
        } else if numbers.len() != self.from.len() {
            Some(format!("{} numbers between braces, but {} sources", numbers.len(), self.from.len()))
        } else {
            // With some numbers for what is between brackets.
            let read = |from: &String| expression::value(Relation::split(from)?.1, &|_| Ok(vec![1.0]));
            self.from.iter().find_map(|from| read(from).err())
        }
    }
}

/// The text of a page; none if there is no such page.
pub fn text_of<'a>(pages: &'a Pages, page: &Path) -> &'a str {
    pages.texts.get(page).map_or("", String::as_str)
}

/// The one block of a page, consoles aside, that has a line.
pub fn block_of<'a>(pages: &'a Pages, page: &Path, line: &str) -> Result<page::Block<'a>, String> {
    let is_meant = |block: &page::Block<'_>| block.kind != "console" && block.lines.contains(&line);
    let mut found: Vec<_> = page::blocks(text_of(pages, page)).into_iter().filter(is_meant).collect();
    let count = found.len();
    match found.pop() {
        Some(block) if count == 1 => Ok(block),
        _ => Err(format!("{}: {count} blocks have the line \"{line}\"", page.display())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_belongs_to_its_page() {
        let pages = Pages::read(&crate::root()).unwrap();
        let list = List::read(&crate::root()).unwrap();
        assert_eq!(list.faults(&pages), Vec::<String>::new());
        assert!(list.run.iter().map(|run| run.quote.len()).sum::<usize>() > 50);
    }

    #[test]
    fn entries_that_do_not_belong_are_found() {
        let mut pages = Pages::read(&crate::root()).unwrap();
        let text = "K is 3.2 or\n4.5 here.\n\n```text\nfirst\n```\n";
        pages.texts.insert("a.md".into(), text.into());
        let of = |entry: &str| {
            let text = format!("brought = []\n[[run]]\npage = \"a.md\"\ncommands = [\"voronudge\"]\n{entry}");
            toml::from_str::<List>(&text).unwrap().faults(&pages)
        };
        assert_eq!(
            of("quote = [{ words = \"K is {3.2} or {4.5}\", from = ['[/a]', 'within 0.1 of [/b] / 2'] }]")
                .len(),
            0
        );
        assert_eq!(of("quote = [{ words = \"K is 3.2\" }]\nblock = [{ line = \"first\" }]").len(), 0);
        assert_eq!(of(""), ["a.md: a run without commands, or of which nothing is quoted"]);
        for wrong in [
            "quote = [{ words = \"K is {3.3}\", from = ['[/a]'] }]",
            "quote = [{ words = \"K is {3.2}\" }]",
            "quote = [{ words = \"K {is} 3.2\", from = ['[/a]'] }]",
            "quote = [{ words = \"K is {3.2}\", from = ['[/a'] }]",
            "quote = [{ words = \"K is {3.2}\", from = ['within [/a]'] }]",
            "quote = [{ words = \"K is {3.2}\", from = ['[/a]'], page = \"b.md\" }]",
            "block = [{ line = \"second\" }]",
        ] {
            assert_eq!(of(wrong).len(), 1, "{wrong}");
        }
    }

    #[test]
    fn numbers_are_compared_as_the_list_says() {
        let printed = number::parse("0.34").unwrap();
        let holds = |from: &str, value| Relation::split(from).unwrap().0.holds(printed, value);
        assert!(holds("[a]", 0.344) && !holds("[a]", 0.346));
        assert!(holds("within 0.1 of [a]", 0.43) && !holds("within 0.1 of [a]", 0.45));
        assert!(holds("at most [a]", 0.3) && !holds("at most [a]", 0.35));
        assert!(
            holds("at least [a]", 0.35) && !holds("at least [a]", 0.3) && !holds("at least [a]", f64::NAN)
        );
    }
}
