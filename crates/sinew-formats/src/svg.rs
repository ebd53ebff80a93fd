//! Lines, circles, squares, cells and words as SVG.

use crate::xml_text::escaped;
use std::fmt::Write as _;

/// Characters of a name that are shown.
const SHOWN: usize = 40;

/// A picture in the making.
pub struct Svg {
    text: String,
}

/// A name that is not too long.
#[must_use]
pub fn clipped(name: &str) -> String {
    name.chars().take(SHOWN).collect()
}

/// What of words stands at their place.
#[derive(Clone, Copy)]
pub enum Anchor {
    /// Their middle.
    Middle,
    /// Their end.
    End,
}

impl Anchor {
    const fn name(self) -> &'static str {
        match self {
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

impl Svg {
    /// A white picture of that width and height, pixels.
    #[must_use]
    pub fn new(width: f64, height: f64) -> Self {
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        Self { text }
    }

    fn put(&mut self, line: std::fmt::Arguments<'_>) {
        let _ = self.text.write_fmt(line);
        self.text.push('\n');
    }

    /// Words that begin at a place.
    pub fn text(&mut self, x: f64, y: f64, size: f64, words: &str) {
        let words = escaped(words);
        self.put(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size:.0}\" fill=\"#111827\">{words}</text>"
        ));
    }

    /// Words that do not begin at their place.
    pub fn label(&mut self, [x, y]: [f64; 2], size: f64, anchor: Anchor, words: &str) {
        let (words, anchor) = (escaped(words), anchor.name());
        self.put(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size:.0}\" fill=\"#111827\" text-anchor=\"{anchor}\">{words}</text>"
        ));
    }

    /// Words that run upwards, their middle at a place.
    pub fn upright(&mut self, [x, y]: [f64; 2], size: f64, words: &str) {
        let words = escaped(words);
        self.put(format_args!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" font-size=\"{size:.0}\" fill=\"#111827\" text-anchor=\"middle\">{words}</text>"
        ));
    }

    /// A line between two places.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], width: f64, color: &str) {
        self.put(format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
        ));
    }

    /// A filled circle.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, color: &str) {
        self.put(format_args!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{color}\"/>"));
    }

    /// An empty circle, around a point that is pointed out.
    pub fn ring(&mut self, [x, y]: [f64; 2], radius: f64, color: &str) {
        self.put(format_args!(
            "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"none\" stroke=\"{color}\"/>"
        ));
    }

    /// An empty square.
    pub fn frame(&mut self, x: f64, y: f64, side: f64) {
        self.put(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{side:.1}\" height=\"{side:.1}\" fill=\"none\" stroke=\"#9ca3af\"/>"
        ));
    }

    /// A filled square, for one transition.
    pub fn square(&mut self, [x, y]: [f64; 2], side: f64, color: &str) {
        self.put(format_args!(
            "<rect class=\"t\" x=\"{x:.2}\" y=\"{y:.2}\" width=\"{side:.2}\" height=\"{side:.2}\" fill=\"{color}\"/>"
        ));
    }

    /// A line through places.
    pub fn polyline(&mut self, places: &[[f64; 2]], width: f64, color: &str) {
        let points: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.put(format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"/>",
            points.join(" ")
        ));
    }

    /// A dashed line.
    pub fn dashed(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], color: &str) {
        self.put(format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\" stroke-dasharray=\"4 3\"/>"
        ));
    }

    /// A filled outline that lets through what is below, at an opacity of 0 altogether.
    pub fn area(&mut self, outline: &[[f64; 2]], color: &str, opacity: f64) {
        let points: Vec<String> = outline.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        self.put(format_args!(
            "<polygon points=\"{}\" fill=\"{color}\" fill-opacity=\"{opacity:.2}\"/>",
            points.join(" ")
        ));
    }

    /// A filled rectangle that lets through what is below, at an opacity of 0 altogether.
    pub fn cell(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], color: &str, opacity: f64) {
        self.put(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.1}\" width=\"{width:.2}\" height=\"{height:.1}\" fill=\"{color}\" fill-opacity=\"{opacity:.2}\"/>"
        ));
    }

    /// The picture.
    #[must_use]
    pub fn done(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Round numbers within an extent, three to six of them.
#[must_use]
pub fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let power = 10.0_f64.powf((high - low).log10().floor());
    let within = |step: f64| -> Vec<f64> {
        let first = (low / step).ceil();
        (0..8).map(|k| (first + f64::from(k)) * step).filter(|x| (low..=high).contains(x)).collect()
    };
    let mut steps = [5.0, 2.0, 1.0, 0.5, 0.2].into_iter().map(|k| within(k * power));
    steps.find(|ticks| ticks.len() >= 3).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks([-1.1, 1.3]), [-1.0, 0.0, 1.0]);
        assert_eq!(ticks([0.0, 10.0]), [0.0, 5.0, 10.0]);
        for extent in [[-2e-3, 7e-3], [3.0, 3.9], [-120.0, 990.0], [0.0, 1.0], [0.01, 0.99]] {
            let found = ticks(extent);
            assert!((3..=6).contains(&found.len()), "{extent:?}: {found:?}");
        }
    }
}
