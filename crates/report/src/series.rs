//! What a chart shows as numbers, so that a picture hands them on with itself.

/// A point of a chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorPoint {
    /// Place in axis coordinates.
    pub at: [f64; 2],
    /// Standard error along each axis, where known.
    pub error: [Option<f64>; 2],
}

impl ErrorPoint {
    /// Place and errors, NaN where not known.
    fn numbers(&self) -> [f64; 4] {
        let ([x, y], [dx, dy]) = (self.at, self.error.map(|error| error.unwrap_or(f64::NAN)));
        [x, y, dx, dy]
    }
}

impl From<[f64; 2]> for ErrorPoint {
    fn from(at: [f64; 2]) -> Self {
        Self { at, error: [None; 2] }
    }
}

/// The series of a chart, in the order in which they were drawn.
#[derive(Debug, Clone, Default)]
pub(crate) struct SeriesTable {
    series: Vec<(String, Vec<ErrorPoint>)>,
}

impl SeriesTable {
    /// Adds the points of one series.
    pub fn push(&mut self, name: &str, points: impl IntoIterator<Item = ErrorPoint>) {
        self.series.push((name.to_owned(), points.into_iter().collect()));
    }

    /// A table in CSV: a line for each point, with its series, its place along each of the axes and its errors, six digits each. Axes along
    /// which there is no number, such as those of rows with names, have no column. `None` without a number.
    pub fn to_csv(&self, axes: [&str; 2]) -> Option<String> {
        let [x, y] = axes.map(|axis| if axis.trim().is_empty() { "place" } else { axis });
        let columns =
            [x.to_owned(), y.to_owned(), format!("standard error of {x}"), format!("standard error of {y}")];
        let points = || self.series.iter().flat_map(|(_, points)| points);
        let has_number = |column: &usize| points().any(|point| point.numbers()[*column].is_finite());
        let kept: Vec<usize> = (0..columns.len()).filter(has_number).collect();
        if kept.is_empty() {
            return None;
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer
            .write_record(["series"].into_iter().chain(kept.iter().map(|&column| &*columns[column])))
            .ok()?;
        for (name, points) in &self.series {
            for numbers in points.iter().map(ErrorPoint::numbers) {
                let texts = kept.iter().map(|&column| text(numbers[column]));
                writer.write_record([name.clone()].into_iter().chain(texts)).ok()?;
            }
        }
        String::from_utf8(writer.into_inner().ok()?).ok()
    }
}

/// Six digits of a number, as programs read them; nothing of one that is not finite.
fn text(value: f64) -> String {
    match format!("{value:.5e}").parse::<f64>() {
        Ok(rounded) if !rounded.is_finite() => String::new(),
        Ok(rounded) if rounded == 0.0 || (1e-4..1e15).contains(&rounded.abs()) => rounded.to_string(),
        Ok(rounded) => format!("{rounded:e}"),
        Err(_) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_columns_where_some_point_has_one() {
        let mut table = SeriesTable::default();
        assert_eq!(table.to_csv(["x", "y"]), None);
        table.push("P_0, \"fitted\"", [ErrorPoint { at: [1.0, f64::NAN], error: [None, Some(0.25)] }]);
        table.push("", [[0.123456789, -3e-12].into()]);
        let lines = [
            "series,q (µm⁻¹),rate,standard error of rate",
            "\"P_0, \"\"fitted\"\"\",1,,0.25",
            ",0.123457,-3e-12,",
        ];
        assert_eq!(table.to_csv(["q (µm⁻¹)", "rate"]).unwrap().lines().collect::<Vec<_>>(), lines);
    }
}
