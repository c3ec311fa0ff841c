//! Pens of curves, and the names beside samples of them.

use super::text;

/// How a curve is drawn: a colour, a dash, and whether it is thin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pen {
    /// Which of the eight colours of the style sheet.
    pub colour: usize,
    /// Which of the four dashes; the first one is solid.
    pub dash: usize,
    /// Whether it is drawn thinner.
    pub thin: bool,
}

/// Colours in the style sheet.
pub const COLOURS: usize = 8;
/// Dashes in the style sheet.
const DASHES: usize = 4;
/// Pens that can be told apart.
pub const PENS: usize = 2 * COLOURS;

impl Pen {
    /// The pen of a curve among others: first the colours, then the same ones thin.
    pub fn of(index: usize) -> Self {
        let thin = index / COLOURS % 2 == 1;
        Self { colour: index % COLOURS, dash: index % DASHES, thin }
    }

    /// A pen of a colour that has a meaning of its own; the index tells by dash and width.
    pub fn coloured(colour: usize, index: usize) -> Self {
        Self { colour, dash: index % DASHES, thin: index / DASHES % 2 == 1 }
    }

    /// Its classes in the style sheet.
    pub(super) fn classes(self) -> String {
        let thin = if self.thin { " thin" } else { "" };
        format!("curve c{} d{}{thin}", self.colour % COLOURS, self.dash % DASHES)
    }
}

/// Where the first row of a legend stands, and how far rows are apart.
pub(super) const LEGEND: f64 = 35.0;
pub(super) const ROW: f64 = 17.0;

/// Length of a sample, what lies between it and its name, and between a name and the next sample.
const SAMPLE: f64 = 22.0;
const BESIDE: f64 = 5.0;
const APART: f64 = 14.0;

/// Names beside samples of lines, which have these classes: in rows from `left` to `right`, the first one at the height
/// `top`, and how many rows they are.
pub(super) fn legend(
    named: &[(&str, String)],
    [left, right]: [f64; 2],
    top: f64,
) -> (String, usize) {
    let mut svg = String::new();
    let (mut x, mut rows) = (left, 0);
    for (name, classes) in named.iter().filter(|(name, _)| !name.is_empty()) {
        let name = fitting(name, right - left - SAMPLE - BESIDE);
        let length = SAMPLE + BESIDE + width(&name);
        if rows == 0 || x + length > right {
            (x, rows) = (left, rows + 1);
        }
        let y = top + ROW * (rows - 1) as f64;
        svg += &format!(
            "<path class=\"{classes}\" d=\"M{x:.1} {0:.1}L{1:.1} {0:.1}\"/>",
            y - 4.0,
            x + SAMPLE
        );
        svg += &text([x + SAMPLE + BESIDE, y], "start", &name);
        x += length + APART;
    }
    (svg, rows)
}

/// A text that has room in a length: of a longer one the beginning and the end, which tell names and values.
pub(super) fn fitting(text: &str, length: f64) -> String {
    let most = (length / LETTER).floor().max(3.0) as usize;
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most {
        return text.to_owned();
    }
    let end = (most - 1) / 2;
    let begin = most - 1 - end;
    letters[..begin].iter().chain(&['…']).chain(&letters[letters.len() - end..]).collect()
}

/// About the width of a letter, since nobody knows the font.
const LETTER: f64 = 7.2;

fn width(text: &str) -> f64 {
    LETTER * text.chars().count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_do_not_fit_go_on_in_another_row() {
        let named = vec![("a long name of a curve", Pen::of(0).classes()); 5];
        let (svg, rows) = legend(&named, [0.0, 400.0], LEGEND);
        assert_eq!((rows, svg.matches("<text").count()), (3, 5));
        assert_eq!(legend(&[("", String::new())], [0.0, 400.0], LEGEND), (String::new(), 0));
        let (svg, rows) = legend(&named[..1], [0.0, 100.0], LEGEND);
        assert!(rows == 1 && svg.contains(">a lon…urve<"), "{svg}");
    }

    #[test]
    fn pens_are_told_apart() {
        let all: Vec<String> = (0..PENS).map(|index| Pen::of(index).classes()).collect();
        for (index, classes) in all.iter().enumerate() {
            assert!(!all[..index].contains(classes), "{classes}");
        }
        let of_colour = |index| Pen::coloured(4, index);
        assert!(
            (1..8).all(|index| of_colour(index) != of_colour(0)) && of_colour(8) == of_colour(0)
        );
    }
}
