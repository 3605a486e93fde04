//! What a style changes of a drawing: the size of a figure pixel and of the page, the weight of lines, typeface,
//! colours.

use plotters::style::colors::colormaps::{ColorMap as _, ViridisRGB};

use super::style::{Colour, TEXT};

/// Points in a millimetre.
pub(in crate::figure) const POINTS_A_MILLIMETRE: f64 = 72.0 / 25.4;
/// Points of a figure pixel that nobody asked for otherwise: 96 to the inch.
const USUAL_POINTS: f64 = 0.75;

/// Colours for shares of a largest value: perceptually uniform, safe for colour-blind readers, and monotone in grey.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ColourMap {
    /// Dark blue over green to yellow.
    #[default]
    Viridis,
    /// Blue over grey to yellow: nearly the same to all colour vision.
    Cividis,
    /// Black over purple and orange to pale yellow.
    Magma,
    /// White to black, for print without colour.
    Grey,
}

impl ColourMap {
    /// All colour maps.
    pub const ALL: [Self; 4] = [Self::Viridis, Self::Cividis, Self::Magma, Self::Grey];

    /// Name used in sweep files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viridis => "viridis",
            Self::Cividis => "cividis",
            Self::Magma => "magma",
            Self::Grey => "grey",
        }
    }

    /// Red, green and blue of a share, clamped to 0 to 1.
    pub fn colour(self, share: f64) -> (u8, u8, u8) {
        let share = share.clamp(0.0, 1.0);
        let of = |gradient: colorous::Gradient| {
            let colour = gradient.eval_continuous(share);
            (colour.r, colour.g, colour.b)
        };
        match self {
            Self::Viridis => {
                let colour = ViridisRGB.get_color(share as f32);
                (colour.0, colour.1, colour.2)
            }
            Self::Cividis => of(colorous::CIVIDIS),
            Self::Magma => of(colorous::MAGMA),
            Self::Grey => {
                let grey = (255.0 * (1.0 - share)).round() as u8;
                (grey, grey, grey)
            }
        }
    }
}

/// The typeface: one family each, which comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Typeface {
    /// DejaVu Sans.
    #[default]
    Sans,
    /// DejaVu Serif.
    Serif,
}

impl Typeface {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Sans, Self::Serif];

    /// Name used in sweep files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sans => "sans",
            Self::Serif => "serif",
        }
    }

    /// The families of an SVG, in the order in which they are looked for.
    pub(super) fn families(self) -> &'static str {
        match self {
            Self::Sans => "'DejaVu Sans', Verdana, sans-serif",
            Self::Serif => "'DejaVu Serif', Georgia, serif",
        }
    }
}

/// How a drawing looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::figure) struct Look {
    /// Width of every page, in figure pixels; `None` for each figure's own.
    pub(in crate::figure) page: Option<f64>,
    /// Points of a figure pixel.
    pub(in crate::figure) points: f64,
    /// Weight of lines, as a multiple of the usual one.
    pub(in crate::figure) lines: f64,
    /// Pixels of a PNG to the inch.
    pub(in crate::figure) dpi: f64,
    /// Typeface.
    pub(in crate::figure) typeface: Typeface,
    /// Colours of maps.
    pub(in crate::figure) colours: ColourMap,
    /// Whether the ground is dark.
    pub(in crate::figure) is_dark: bool,
    /// Whether the title of the run stands above.
    pub(in crate::figure) has_title: bool,
    /// Whether panels have letters.
    pub(in crate::figure) has_letters: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            page: None,
            points: USUAL_POINTS,
            lines: 1.0,
            dpi: 288.0,
            typeface: Typeface::default(),
            colours: ColourMap::default(),
            is_dark: false,
            has_title: true,
            has_letters: true,
        }
    }
}

impl Look {
    /// Points of a figure pixel that make the lettering of axis titles that many points high.
    pub(in crate::figure) fn points_for(text: f64) -> f64 {
        text / TEXT
    }

    /// Whether figure pixels are the usual ones, 96 to the inch.
    pub(super) fn is_usual_size(&self) -> bool {
        self.points == USUAL_POINTS
    }

    /// Millimetres of a length in figure pixels.
    pub(super) fn millimetres(&self, pixels: f64) -> f64 {
        pixels * self.points / POINTS_A_MILLIMETRE
    }

    /// A panel's width where everything beside it takes `beside`: what the page leaves, or its own.
    pub(in crate::figure) fn fill(&self, own: f64, beside: f64) -> f64 {
        self.page.map_or(own, |page| (page - beside).max(40.0))
    }

    /// A panel's height on a page of this width: `own` belongs to a page that is `usual` wide.
    pub(in crate::figure) fn height(&self, own: f64, usual: f64) -> f64 {
        self.page
            .map_or(own, |page| own * (page / usual).clamp(0.62, 1.3))
    }

    /// A colour on this ground, and its opacity.
    pub(in crate::figure) fn resolve(&self, colour: Colour) -> ((u8, u8, u8), f64) {
        let rgb = if self.is_dark {
            colour.dark
        } else {
            colour.light
        };
        (rgb, colour.alpha)
    }
}

#[cfg(test)]
mod tests {
    use super::super::style::luminance;
    use super::*;

    #[test]
    fn maps_grow_lighter_or_darker_all_along() {
        for map in ColourMap::ALL {
            let values: Vec<f64> = (0..=100)
                .map(|i| luminance(map.colour(f64::from(i) / 100.0)))
                .collect();
            let up = values.windows(2).all(|pair| pair[1] > pair[0] - 3e-3);
            let down = values.windows(2).all(|pair| pair[1] < pair[0]);
            assert!(up || down, "{map:?}: {values:?}");
            assert_eq!(map.colour(-1.0), map.colour(0.0));
            assert_eq!(map.colour(2.0), map.colour(1.0));
        }
    }
}
