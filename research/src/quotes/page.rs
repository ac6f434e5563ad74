//! What pages have between fences, and where words stand in them.

/// The text between two fences.
#[derive(Debug, PartialEq)]
pub struct Block<'a> {
    /// Line of its first line, counted from 1.
    pub line: usize,
    /// `console`, `sh`, `text`, …
    pub kind: &'a str,
    pub lines: Vec<&'a str>,
}

/// A command of a console, and what stands below it.
#[derive(Debug, PartialEq)]
pub struct Typed<'a> {
    pub line: usize,
    pub command: &'a str,
    pub below: Vec<&'a str>,
}

/// The blocks of a page, in order.
pub fn blocks(text: &str) -> Vec<Block<'_>> {
    let mut found: Vec<Block<'_>> = Vec::new();
    let mut is_open = false;
    for (number, line) in (1..).zip(text.lines()) {
        match line.trim_start().strip_prefix("```") {
            Some(kind) if !is_open => {
                found.push(Block { line: number + 1, kind: kind.trim(), lines: Vec::new() });
                is_open = true;
            }
            Some(_) => is_open = false,
            None if is_open => found.last_mut().into_iter().for_each(|block| block.lines.push(line)),
            None => {}
        }
    }
    found
}

impl<'a> Block<'a> {
    /// The commands of a console; none of other blocks.
    pub fn typed(&self) -> Vec<Typed<'a>> {
        let mut found: Vec<Typed<'a>> = Vec::new();
        if self.kind != "console" {
            return found;
        }
        for (number, line) in (self.line..).zip(&self.lines) {
            if let Some(command) = line.strip_prefix("$ ") {
                found.push(Typed { line: number, command, below: Vec::new() });
            } else if let Some(last) = found.last_mut() {
                last.below.push(line);
            }
        }
        found
    }
}

/// Lines of a text in which these words begin, line breaks counted as blanks.
pub fn places(text: &str, words: &str) -> Vec<usize> {
    let sought: Vec<&str> = words.split_whitespace().collect();
    let joined = sought.join(" ");
    let (mut flat, mut lines) = (String::new(), Vec::new());
    for (number, line) in (1..).zip(text.lines()) {
        for word in line.split_whitespace() {
            lines.push((flat.len(), number));
            flat.push_str(word);
            flat.push(' ');
        }
    }
    let line_of = |place: usize| {
        let after = lines.partition_point(|(begin, _)| *begin <= place);
        lines[after.saturating_sub(1)].1
    };
    if joined.is_empty() {
        return Vec::new();
    }
    flat.match_indices(&joined).map(|(place, _)| line_of(place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# A\n\n```console\n$ one --a\nfirst\n\nsecond\n$ two\n```\n\nWords that\ngo on, and words.\n```sh\n$ no\n```\n";

    #[test]
    fn consoles_have_commands_and_what_they_print() {
        let blocks = blocks(PAGE);
        assert_eq!(
            blocks.iter().map(|block| (block.line, block.kind)).collect::<Vec<_>>(),
            [(4, "console"), (14, "sh")]
        );
        let expected = [
            Typed { line: 4, command: "one --a", below: vec!["first", "", "second"] },
            Typed { line: 8, command: "two", below: vec![] },
        ];
        assert_eq!(blocks[0].typed(), expected);
        assert!(blocks[1].typed().is_empty());
    }

    #[test]
    fn words_are_found_across_lines() {
        assert_eq!(places(PAGE, "that go on"), [11]);
        assert_eq!(places(PAGE, "go on,"), [12]);
        assert_eq!(places(PAGE, "ords"), [11, 12]);
        assert!(places(PAGE, "that goes on").is_empty() && places(PAGE, " ").is_empty());
    }
}
