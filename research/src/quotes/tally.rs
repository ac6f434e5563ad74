//! Running what pages quote, and counting what agrees.

use super::compare;
use super::expression;
use super::found::Left;
use super::list::{self, List, Relation, Run};
use super::page::{self, Typed};
use super::scratch::{self, Printed, Ran, Scratch};
use serde_json::Value;
use std::error::Error;
use std::path::Path;
use xtask::pages::Pages;

/// What came of quotes.
#[derive(Debug, Default)]
pub struct Tally {
    pub agreed: usize,
    /// Where, what stands there, what came out, and by which command.
    pub off: Vec<String>,
    /// What was not run, and why.
    pub out: Vec<String>,
    /// Processor time.
    pub seconds: f64,
}

/// What there is to do, and how.
pub struct Work<'a> {
    pub root: &'a Path,
    pub pages: &'a Pages,
    pub list: &'a List,
    pub limit: f64,
    pub brought: Option<&'a Path>,
    pub is_asked: &'a (dyn Fn(&Path) -> bool + Sync),
}

impl Tally {
    pub fn add(&mut self, other: Self) {
        self.agreed += other.agreed;
        self.off.extend(other.off);
        self.out.extend(other.out);
        self.seconds += other.seconds;
    }

    pub fn tell(&self) {
        self.off.iter().for_each(|line| println!("off: {line}"));
        self.out.iter().for_each(|line| println!("not run: {line}"));
        println!(
            "{} quotes were run in {:.0} s of processor time: {} agree, {} are off; {} entries were not run",
            self.agreed + self.off.len(),
            self.seconds,
            self.agreed,
            self.off.len(),
            self.out.len()
        );
    }

    /// Compares lines of a page, of which the first stands at a place, with what a command prints.
    fn lines(&mut self, stand: &[&str], printed: &str, (page, first): (&Path, usize), command: &str) {
        let difference = compare::difference(stand, printed);
        self.compare(difference.is_none(), || {
            let (at, came) = difference.unwrap_or_default();
            let stands = stand.get(at).copied().unwrap_or(NOTHING);
            let came = if came.is_empty() { NOTHING.into() } else { came.join("\n    ") };
            unlike(&place(page, first + at), stands, &came, command)
        });
    }

    fn compare(&mut self, agrees: bool, otherwise: impl FnOnce() -> String) {
        if agrees {
            self.agreed += 1;
        } else {
            self.off.push(otherwise());
        }
    }
}

impl Work<'_> {
    /// Runs the consoles of a page in one folder, as a reader would.
    pub fn consoles(&self, page: &Path) -> Result<Tally, Box<dyn Error>> {
        let mut tally = Tally::default();
        let scratch = Scratch::new(self.root, self.brought)?;
        for file in self.list.file.iter().filter(|file| file.page == page) {
            let mut text = list::block_of(self.pages, page, &file.line)?.lines.join("\n") + "\n";
            if let Some([old, new]) = &file.replaced {
                text = text.replacen(old, new, 1);
            }
            std::fs::write(scratch.path().join(&file.name), text)?;
        }
        for block in page::blocks(list::text_of(self.pages, page)) {
            let typed = block.typed();
            let Some(first) = typed.first() else { continue };
            let said = self.list.said_of(page, first.command);
            let too_long = said
                .filter(|said| said.seconds > self.limit)
                .map(|said| format!("takes {:.0} s", said.seconds));
            if let Some(why) = said.and_then(|said| said.because.clone()).or(too_long) {
                tally.out.push(format!("{}: {}: {why}", place(page, first.line), first.command));
                continue;
            }
            for typed in typed {
                if !self.console(page, &scratch, &typed, &mut tally)? {
                    break;
                }
            }
        }
        Ok(tally)
    }

    /// Runs a command of a console; whether the next can be run.
    fn console(
        &self,
        page: &Path,
        scratch: &Scratch,
        typed: &Typed<'_>,
        tally: &mut Tally,
    ) -> Result<bool, Box<dyn Error>> {
        let Typed { line, command, below } = typed;
        let printed = match self.ended(scratch, command, self.limit)? {
            Ok(printed) => printed,
            Err(why) => {
                tally.out.push(format!("{}: {command}: {why}", place(page, *line)));
                return Ok(false);
            }
        };
        tally.seconds += printed.seconds;
        if below.iter().all(|line| line.trim().is_empty()) {
            if !has_worked(&printed) {
                tally.off.push(format!("{}: {}\n    {command}", place(page, *line), last_line(&printed)));
            }
            return Ok(true);
        }
        tally.lines(below, &printed.text, (page, line + 1), command);
        Ok(true)
    }

    /// Runs commands of the list and compares what is quoted of them.
    pub fn run(&self, run: &Run) -> Result<Tally, Box<dyn Error>> {
        let mut tally = Tally::default();
        let typed = run.told();
        let mut give_up = |why: String| tally.out.push(format!("{}: {typed}: {why}", run.page.display()));
        if run.seconds > self.limit {
            give_up(format!("takes {:.0} s", run.seconds));
            return Ok(tally);
        }
        let scratch = Scratch::new(self.root, self.brought)?;
        let (mut all, mut last, mut seconds) = (String::new(), String::new(), 0.0);
        for command in &run.commands {
            match self.ended(&scratch, command, self.limit - seconds)? {
                Ok(printed) if has_worked(&printed) => {
                    seconds += printed.seconds;
                    all.push_str(&printed.text);
                    last = printed.text;
                }
                Ok(printed) => return Err(last_line(&printed).into()),
                Err(why) => {
                    give_up(why);
                    return Ok(tally);
                }
            }
        }
        tally.seconds = seconds;
        let out = run.commands.last().map(|command| scratch::out(command)).unwrap_or_default();
        let left = Left { folder: scratch.path(), out: &out, printed: &all };
        for quote in run.quote.iter().filter(|quote| (self.is_asked)(quote.page(run))) {
            self.words(quote, run, &left, &last, &mut tally);
        }
        for copy in run.block.iter().filter(|copy| (self.is_asked)(copy.page(run))) {
            let block = list::block_of(self.pages, copy.page(run), &copy.line)?;
            let is = copy
                .file
                .as_ref()
                .map(|file| std::fs::read_to_string(scratch.path().join(file)))
                .transpose()?;
            let printed = is.as_ref().unwrap_or(&last);
            tally.lines(&block.lines, printed, (copy.page(run), block.line), &typed);
        }
        for name in &run.figure {
            self.figure(name, run, scratch.path().join(&out).as_path(), &mut tally)?;
        }
        Ok(tally)
    }

    fn words(&self, quote: &list::Quote, run: &Run, left: &Left<'_>, last: &str, tally: &mut Tally) {
        let page = quote.page(run);
        let line = page::places(list::text_of(self.pages, page), &quote.plain())
            .first()
            .copied()
            .unwrap_or_default();
        let (place, typed) = (place(page, line), run.told());
        if quote.from.is_empty() {
            let told = || format!("{place}: \"{}\" is not printed\n    {typed}", quote.plain());
            tally.compare(compare::has_words(last, &quote.plain()), told);
        }
        for ((text, printed), from) in quote.numbers().into_iter().zip(&quote.from) {
            let value = Relation::split(from).and_then(|(relation, expression)| {
                Ok((relation, expression::value(expression, &|source| left.numbers(source))?))
            });
            match (printed, value) {
                (Some(printed), Ok((relation, value))) => {
                    tally.compare(relation.holds(printed, value), || {
                        format!(
                            "{place}: {text} stands there, {} came out ({from})\n    {typed}",
                            printed.alike(value)
                        )
                    })
                }
                (_, Err(error)) => tally.off.push(format!("{place}: {text}: {error}\n    {typed}")),
                (None, _) => tally.off.push(format!("{place}: {text} is no number")),
            }
        }
    }

    /// Compares the record of a figure with that of the gallery.
    fn figure(&self, name: &str, run: &Run, out: &Path, tally: &mut Tally) -> Result<(), Box<dyn Error>> {
        let read = |path: &Path| -> Result<Value, Box<dyn Error>> {
            let record: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
            record.get(name).cloned().ok_or_else(|| format!("{}: no figure {name}", path.display()).into())
        };
        let (stands, came) =
            (read(&self.root.join(crate::figures::FOLDER).join(RECORD))?, read(&out.join(RECORD))?);
        let sought = format!("`cargo xtask figures {name}`");
        let line =
            page::places(list::text_of(self.pages, &run.page), &sought).first().copied().unwrap_or_default();
        let (stands, came) = (sentences(&stands), sentences(&came));
        for at in 0..stands.len().max(came.len()) {
            let [stands, came] = [&stands, &came].map(|all| all.get(at).map_or(NOTHING, String::as_str));
            tally.compare(stands == came, || unlike(&place(&run.page, line), stands, came, &sought));
        }
        Ok(())
    }

    /// Runs a command to its end, or says why not.
    fn ended(
        &self,
        scratch: &Scratch,
        command: &str,
        limit: f64,
    ) -> Result<Result<Printed, String>, Box<dyn Error>> {
        Ok(match scratch.run(command, &self.list.brought, limit)? {
            Ran::Ended(printed) => Ok(printed),
            Ran::TooLong => Err(format!("stopped after {limit:.0} s of processor time")),
            Ran::Lacks(name) => Err(format!("needs {name}, which a reader brings")),
        })
    }
}

/// What stands beyond the end.
const NOTHING: &str = "(nothing more)";
/// What is kept of figures.
const RECORD: &str = "record.json";

/// All that the record of a figure says.
fn sentences(entry: &Value) -> Vec<String> {
    match entry {
        Value::String(text) => vec![text.clone()],
        Value::Array(all) => all.iter().flat_map(sentences).collect(),
        Value::Object(all) => all.values().flat_map(sentences).collect(),
        _ => Vec::new(),
    }
}

fn unlike(place: &str, stands: &str, came: &str, command: &str) -> String {
    format!("{place}: stands there\n    {stands}\n  came out\n    {came}\n  of\n    {command}")
}

fn place(page: &Path, line: usize) -> String {
    format!("{}:{line}", page.display())
}

/// Whether a command did what it was asked for, be the answer negative.
fn has_worked(printed: &Printed) -> bool {
    matches!(printed.code, Some(0 | 1))
}

fn last_line(printed: &Printed) -> String {
    let error = printed.text.lines().find(|line| line.starts_with("error")).or(printed.text.lines().last());
    format!("ended with {:?}: {}", printed.code, error.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// What comes of a page and a list, with the program itself.
    fn tally(page: &str, list: &str) -> Tally {
        let root = crate::root();
        let mut pages = Pages::read(&root).unwrap();
        pages.texts.insert("a.md".into(), page.into());
        let list: List = toml::from_str(&format!("brought = [\"my-tissue\"]\n{list}")).unwrap();
        let work =
            Work { root: &root, pages: &pages, list: &list, limit: 60.0, brought: None, is_asked: &|_| true };
        let mut tally = work.consoles(&PathBuf::from("a.md")).unwrap();
        list.run.iter().for_each(|run| tally.add(work.run(run).unwrap()));
        tally
    }

    const COMMAND: &str = "voronudge evaluate fixtures/reference-small --alpha 0 --out out";

    #[test]
    fn numbers_that_are_off_are_told_with_their_place() {
        let list = format!(
            "[[run]]\npage = \"a.md\"\ncommands = [\"{COMMAND}\"]\nquote = [\
             {{ words = \"{{20}} or {{21}} cells\", from = ['[/cells/present/0]', '[/cells/present/0]'] }},\
             {{ words = \"20 cells, 20 that count\" }}, {{ words = \"no cells\" }},\
             {{ words = \"area {{1.10}}\", from = ['mean([out/areas.npy])'] }}]\n"
        );
        let tally = tally("There are\n20 or 21 cells, area 1.10,\n20 cells, 20 that count, no cells", &list);
        assert_eq!((tally.agreed, tally.off.len(), tally.out.len()), (3, 2, 0), "{:?}", tally.off);
        assert!(tally.off[0].starts_with("a.md:2: 21 stands there, 20.00 came out"), "{}", tally.off[0]);
        assert!(tally.off[1].starts_with("a.md:3: \"no cells\" is not printed"), "{}", tally.off[1]);
    }

    #[test]
    fn consoles_are_compared_line_by_line_and_those_of_a_reader_left_out() {
        let page = format!(
            "```console\n$ {COMMAND}\n…\nwritten to out\n```\n```console\n$ {COMMAND}\nwritten to out\n```\n\
             ```console\n$ voronudge infer my-tissue --out fit\n```\n```console\n$ voronudge info nowhere\n```\n"
        );
        let tally = tally(&page, "");
        assert_eq!((tally.agreed, tally.off.len(), tally.out.len()), (1, 2, 1), "{:?}", tally.off);
        assert!(tally.off[0].starts_with("a.md:8: stands there"), "{}", tally.off[0]);
        assert!(tally.off[1].starts_with("a.md:14: ended with Some(2)"), "{}", tally.off[1]);
        assert!(tally.out[0].contains("needs my-tissue"), "{}", tally.out[0]);
    }
}
