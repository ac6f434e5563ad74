//! What a page has a command print, beside what it prints.

/// A line of a page that stands for any lines, none or several.
const LEFT_OUT: &str = "…";
/// What varies from run to run: the number before these words.
const VARIES: [&str; 1] = [" steps per second"];

/// The first line of a page that is not printed as it stands: its place, and what is printed from there on.
pub fn difference(page: &[&str], printed: &str) -> Option<(usize, Vec<String>)> {
    let first = page.iter().position(|line| !line.trim().is_empty())?;
    let (page, printed) =
        (trimmed(page.iter().copied()), trimmed(printed.lines().filter(|line| !is_progress(line))));
    let (place, came) = first_difference(&page, &printed)?;
    Some((first + place, printed.get(came..).unwrap_or_default().to_vec()))
}

/// Whether a command prints these words, line breaks counted as blanks.
pub fn has_words(printed: &str, words: &str) -> bool {
    let joined = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    joined(printed).contains(&joined(words))
}

/// How far a command has come, as told in the course of its work: `fit 3/90, 5s elapsed, 2s left`.
fn is_progress(line: &str) -> bool {
    let told = line.split_once(" elapsed").and_then(|(before, _)| before.rsplit_once(", "));
    told.is_some_and(|(stage, time)| {
        let count = stage.rsplit(' ').next().and_then(|word| word.split_once('/'));
        time.starts_with(|digit: char| digit.is_ascii_digit()) && count.is_some_and(is_count)
    })
}

fn is_count((done, total): (&str, &str)) -> bool {
    [done, total]
        .iter()
        .all(|number| !number.is_empty() && number.chars().all(|digit| digit.is_ascii_digit()))
}

/// Lines without blanks at their ends and without what varies, from the first that is not empty to the last.
fn trimmed<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut lines: Vec<String> = lines.map(masked).skip_while(String::is_empty).collect();
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    lines
}

fn masked(line: &str) -> String {
    let mut line = line.trim_end().to_owned();
    for words in VARIES {
        if let Some(end) = line.find(words) {
            let begin = line[..end].trim_end_matches(|digit: char| digit.is_ascii_digit()).len();
            line.replace_range(begin..end, LEFT_OUT);
        }
    }
    line
}

/// Places in both of the first lines that differ.
fn first_difference(page: &[String], printed: &[String]) -> Option<(usize, usize)> {
    let same =
        page.iter().zip(printed).take_while(|(page, printed)| *page != LEFT_OUT && page == printed).count();
    match page.get(same) {
        None if same == printed.len() => None,
        Some(line) if line == LEFT_OUT => {
            let rest = &page[same + 1..];
            let differences = (same..=printed.len()).map(|from| first_difference(rest, &printed[from..]));
            let mut farthest = (same + 1, same);
            for (from, difference) in (same..).zip(differences) {
                match difference {
                    None => return None,
                    Some((place, came)) if same + 1 + place > farthest.0 => {
                        farthest = (same + 1 + place, from + came)
                    }
                    Some(_) => {}
                }
            }
            Some(farthest)
        }
        _ => Some((same, same)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(page: &[&str], printed: &str) -> Option<(usize, String)> {
        difference(page, printed).map(|(place, came)| (place, came.join("/")))
    }

    #[test]
    fn blocks_agree_line_by_line() {
        assert_eq!(place(&["", "a", "", "b", ""], "a  \n\nb\n"), None);
        assert_eq!(place(&["", "a", "b"], "a\nc\n"), Some((2, "c".into())));
        assert_eq!(place(&["a", "b"], "a\n"), Some((1, String::new())));
        assert_eq!(place(&["a"], "a\nb\n"), Some((1, "b".into())));
        assert_eq!(place(&[], "a\n"), None);
    }

    #[test]
    fn lines_that_are_left_out_may_be_any() {
        assert_eq!(place(&["a", "…", "d"], "a\nb\nc\nd\n"), None);
        assert_eq!(place(&["a", "…", "b"], "a\nb\n"), None);
        assert_eq!(place(&["…", "b", "…"], "a\nb\nc\nb\n"), None);
        assert_eq!(place(&["a", "…", "c", "d"], "a\nb\nc\ne\n"), Some((3, "e".into())));
        assert_eq!(place(&["a", "…", "d"], "b\nd\n"), Some((0, "b/d".into())));
    }

    #[test]
    fn what_varies_does_not_count() {
        assert_eq!(place(&["2000 steps, 3046 steps per second"], "2000 steps, 12 steps per second\n"), None);
        assert!(place(&["2000 steps, 3046 steps per second"], "2001 steps, 12 steps per second\n").is_some());
        assert_eq!(place(&["a"], "fit 12/90, 7 s elapsed, 3 s left\na\n"), None);
        assert!(place(&["a"], "fit of 1/2, elapsed\na\n").is_some());
        assert!(place(&["a"], "no time elapsed and/or lost\na\n").is_some());
    }

    #[test]
    fn words_are_printed_whatever_the_line_breaks() {
        assert!(has_words("| 1 |  2 |\n| 3 |", "| 2 | | 3"));
        assert!(!has_words("| 1 |  2 |\n| 3 |", "| 2 | 3"));
    }
}
