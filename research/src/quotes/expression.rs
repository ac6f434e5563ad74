//! How a number of a page follows from what a command leaves behind: `100 * [/nmse/naive]`, `max([out/a.npy :,0])`.

/// Finds the numbers that stand between brackets.
pub type Source<'a> = dyn Fn(&str) -> Result<Vec<f64>, String> + 'a;

/// The value of an expression.
pub fn value(text: &str, source: &Source<'_>) -> Result<f64, String> {
    let mut reader = Reader { letters: text.chars().collect(), at: 0, source };
    let found = reader.sum()?;
    reader.blanks();
    if reader.at < reader.letters.len() {
        return Err(format!("{text}: nothing is known from the {}th sign on", reader.at + 1));
    }
    match found[..] {
        [single] => Ok(single),
        _ => Err(format!("{text}: {} numbers, where one is needed", found.len())),
    }
}

struct Reader<'a> {
    letters: Vec<char>,
    at: usize,
    source: &'a Source<'a>,
}

impl Reader<'_> {
    fn sum(&mut self) -> Result<Vec<f64>, String> {
        let mut left = self.product()?;
        loop {
            let apply = match self.next() {
                Some('+') => |a: f64, b: f64| a + b,
                Some('-') => |a: f64, b: f64| a - b,
                _ => return Ok(left),
            };
            self.at += 1;
            left = paired(left, self.product()?, apply)?;
        }
    }

    fn product(&mut self) -> Result<Vec<f64>, String> {
        let mut left = self.factor()?;
        loop {
            let apply = match self.next() {
                Some('*') => |a: f64, b: f64| a * b,
                Some('/') => |a: f64, b: f64| a / b,
                _ => return Ok(left),
            };
            self.at += 1;
            left = paired(left, self.factor()?, apply)?;
        }
    }

    fn factor(&mut self) -> Result<Vec<f64>, String> {
        match self.next() {
            Some('-') => {
                self.at += 1;
                Ok(self.factor()?.into_iter().map(|value| -value).collect())
            }
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.expect(')')?;
                Ok(inner)
            }
            Some('[') => {
                let text: String =
                    self.letters[self.at + 1..].iter().take_while(|end| **end != ']').collect();
                self.at += 1 + text.chars().count();
                self.expect(']')?;
                (self.source)(&text)
            }
            Some(letter) if letter.is_alphabetic() => {
                let name = self.word(char::is_alphanumeric);
                self.expect('(')?;
                let mut inner = self.sum()?;
                while self.next() == Some(',') {
                    self.at += 1;
                    inner.extend(self.sum()?);
                }
                self.expect(')')?;
                applied(&name, &inner)
            }
            _ => {
                let word = self.word(|letter| letter.is_ascii_digit() || matches!(letter, '.' | 'e'));
                word.parse().map(|number| vec![number]).map_err(|_| format!("\"{word}\" is no number"))
            }
        }
    }

    fn blanks(&mut self) {
        while self.letters.get(self.at) == Some(&' ') {
            self.at += 1;
        }
    }

    fn next(&mut self) -> Option<char> {
        self.blanks();
        self.letters.get(self.at).copied()
    }

    fn word(&mut self, belongs: impl Fn(char) -> bool) -> String {
        let word: String = self.letters[self.at..].iter().take_while(|letter| belongs(**letter)).collect();
        self.at += word.chars().count();
        word
    }

    fn expect(&mut self, sign: char) -> Result<(), String> {
        if self.next() != Some(sign) {
            return Err(format!("{} is missing", sign));
        }
        self.at += 1;
        Ok(())
    }
}

/// An operation on numbers one by one, or on one number and all others.
fn paired(left: Vec<f64>, right: Vec<f64>, apply: fn(f64, f64) -> f64) -> Result<Vec<f64>, String> {
    match (&left[..], &right[..]) {
        (_, [one]) => Ok(left.iter().map(|value| apply(*value, *one)).collect()),
        ([one], _) => Ok(right.iter().map(|value| apply(*one, *value)).collect()),
        _ if left.len() == right.len() => {
            Ok(left.iter().zip(&right).map(|(left, right)| apply(*left, *right)).collect())
        }
        _ => Err(format!("{} numbers against {}", left.len(), right.len())),
    }
}

fn applied(name: &str, values: &[f64]) -> Result<Vec<f64>, String> {
    let each = |apply: fn(f64) -> f64| Ok(values.iter().map(|value| apply(*value)).collect());
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
    match name {
        "abs" => each(f64::abs),
        "sqrt" => each(f64::sqrt),
        "max" => Ok(vec![values.iter().copied().fold(f64::NEG_INFINITY, f64::max)]),
        "min" => Ok(vec![values.iter().copied().fold(f64::INFINITY, f64::min)]),
        "count" => Ok(vec![count]),
        "sum" => Ok(vec![values.iter().sum()]),
        "mean" => Ok(vec![mean]),
        "deviation" => Ok(vec![deviation]),
        "error" => Ok(vec![deviation / count.sqrt()]),
        "median" => Ok(vec![median(values)]),
        _ => Err(format!("there is no function {name}")),
    }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match (sorted.get(middle), sorted.len().is_multiple_of(2)) {
        (Some(upper), true) => 0.5 * (sorted[middle - 1] + upper),
        (Some(single), false) => *single,
        (None, _) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<f64, String> {
        value(text, &|source| match source {
            "a" => Ok(vec![3.0]),
            "out/x.npy 1,:" => Ok(vec![1.0, 2.0, 6.0]),
            other => Err(format!("no {other}")),
        })
    }

    #[test]
    fn expressions_have_the_usual_order() {
        assert_eq!(of("1 + 2 * [a] - 4 / (2 - 1)"), Ok(3.0));
        assert_eq!(of("-[a] * 1e2"), Ok(-300.0));
        assert_eq!(of("max([out/x.npy 1,:] / [a])"), Ok(2.0));
        assert_eq!(of("median([out/x.npy 1,:])"), Ok(2.0));
        assert_eq!(of("mean([a], [out/x.npy 1,:], 2 * 4)"), Ok(4.0));
        assert_eq!(of("sum([out/x.npy 1,:] - [out/x.npy 1,:]) + count([out/x.npy 1,:])"), Ok(3.0));
        assert!(
            (of("deviation([out/x.npy 1,:]) / error([out/x.npy 1,:])").unwrap() - 3.0_f64.sqrt()).abs()
                < 1e-12
        );
    }

    #[test]
    fn what_is_no_expression_is_refused() {
        for no in ["", "1 +", "[b]", "[out/x.npy 1,:]", "([a]", "least([a])", "1 2", "[a] ] 3", "max [a]"] {
            assert!(of(no).is_err(), "{no}");
        }
    }
}
