//! What a style changes of a drawing: the size of a figure pixel and of the page, the weight of lines, typeface,
//! colours.

use plotters::style::colors::colormaps::{ColorMap as _, ViridisRGB};

use super::style::{BLACK, CURVE_LINE, Colour, INK, PAPER, Stroke, TEXT, WHITE, luminance};
use crate::figure::style::{
    ColourMap, ColourScale, FigureStyle, Ground, LEAST_WIDTH, MOST_WIDTH, POINTS_A_MILLIMETRE,
    TEXT_OF_OWN_WIDTH, Typeface,
};

/// Decades of logarithmic colours below the largest density.
pub(crate) const DECADES: f64 = 4.0;

/// A page is never lower than so many figure pixels, unless its height is fixed: with less, panels have no room for
/// their own titles.
const LEAST_HEIGHT: f64 = 600.0;

/// How a drawing looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    /// Width of every page, in figure pixels; `None` for each figure's own.
    pub(crate) page: Option<f64>,
    /// The greatest height of a page, in figure pixels.
    pub(crate) greatest_height: f64,
    /// Whether every page is as high as that.
    pub(crate) has_fixed_height: bool,
    /// Heights of panels as a multiple of the usual ones: what fits a figure to its page.
    pub(crate) tall: f64,
    /// Points of a figure pixel.
    pub(crate) points: f64,
    /// Weight of lines, as a multiple of the usual one.
    pub(crate) lines: f64,
    /// Pixels of a PNG to the inch.
    pub(crate) dpi: f64,
    /// Typeface.
    pub(crate) typeface: Typeface,
    /// Colours of maps.
    pub(crate) colours: ColourMap,
    /// Whether colours of heat maps are logarithmic in the density.
    pub(crate) is_logarithmic: bool,
    /// Whether the ground is dark.
    pub(crate) is_dark: bool,
    /// Whether the title of the run stands above.
    pub(crate) has_title: bool,
    /// Whether panels have letters.
    pub(crate) has_letters: bool,
}

impl Default for Look {
    fn default() -> Self {
        FigureStyle::default().look()
    }
}

impl FigureStyle {
    /// How a drawing in this style looks; what cannot be drawn is taken to what can.
    pub(crate) fn look(&self) -> Look {
        let usable = |value: f64, usual: f64, (least, most): (f64, f64)| {
            let value = if value.is_nan() { usual } else { value };
            value.clamp(least, most)
        };
        let text = usable(self.text_points(), TEXT_OF_OWN_WIDTH, (1.0, 1000.0));
        let points = text / TEXT;
        let bounds = (LEAST_WIDTH * text, MOST_WIDTH * text);
        let page = self.width.millimetres().map(|width| {
            let width = usable(width * POINTS_A_MILLIMETRE, bounds.0, bounds);
            width / points
        });
        let own = self.width.greatest_height() * POINTS_A_MILLIMETRE / points;
        // Lettering that is very large for a page takes more of it.
        let greatest_height = if self.width.has_fixed_height() {
            own
        } else {
            own.max(LEAST_HEIGHT)
        };
        let line = self
            .line
            .map(|line| usable(line, 1.0, (0.01, 100.0)) / (CURVE_LINE * points));
        Look {
            page,
            greatest_height,
            has_fixed_height: self.width.has_fixed_height(),
            tall: 1.0,
            points,
            lines: line.unwrap_or(1.0),
            dpi: usable(self.dpi, Self::default().dpi, (20.0, 2400.0)),
            typeface: self.font,
            colours: self.colours,
            is_logarithmic: self.scale == ColourScale::Log,
            is_dark: self.ground == Ground::Dark,
            has_title: self.title,
            has_letters: self.letters,
        }
    }
}

impl ColourMap {
    /// Red, green and blue of a share, clamped to 0 to 1.
    pub(crate) fn colour(self, share: f64) -> (u8, u8, u8) {
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

impl Typeface {
    /// The families of an SVG, in the order in which they are looked for.
    pub(super) fn families(self) -> &'static str {
        match self {
            Self::Sans => "'DejaVu Sans', Verdana, sans-serif",
            Self::Serif => "'DejaVu Serif', Georgia, serif",
        }
    }
}

impl Look {
    /// Whether figure pixels are the usual ones, 96 to the inch: three quarters of a point.
    pub(super) fn is_usual_size(&self) -> bool {
        self.points == 0.75
    }

    /// Millimetres of a length in figure pixels.
    pub(super) fn millimetres(&self, pixels: f64) -> f64 {
        pixels * self.points / POINTS_A_MILLIMETRE
    }

    /// As many columns as fit, at most so many, at least one.
    pub(crate) fn columns(most: usize, fits: impl Fn(usize) -> bool) -> usize {
        let fitting = (1..=most).rev().find(|&columns| fits(columns));
        fitting.unwrap_or(1)
    }

    /// A panel's width where everything beside it takes `beside`: what the page leaves, or its own.
    pub(crate) fn fill(&self, own: f64, beside: f64) -> f64 {
        self.page.map_or(own, |page| (page - beside).max(40.0))
    }

    /// Columns of a grid with as few places left empty as the rows that so many columns need have.
    pub(crate) fn even_columns(panels: usize, columns: usize) -> usize {
        let rows = panels.max(1).div_ceil(columns.max(1));
        panels.max(1).div_ceil(rows)
    }

    /// A panel's height on a page of this width: `own` belongs to a page that is `usual` wide.
    pub(crate) fn height(&self, own: f64, usual: f64) -> f64 {
        self.tall * self.usual_height(own, usual)
    }

    /// The same before a figure is fitted to its page.
    pub(crate) fn usual_height(&self, own: f64, usual: f64) -> f64 {
        self.page
            .map_or(own, |page| own * (page / usual).clamp(0.62, 1.3))
    }

    /// Where the colour of a density, as a share of the largest, stands between the ends of the colours.
    pub(crate) fn along_colours(&self, share: f64) -> f64 {
        if self.is_logarithmic && !share.is_nan() {
            (1.0 + share.max(0.0).log10() / DECADES).clamp(0.0, 1.0)
        } else {
            share
        }
    }

    /// An opaque colour of areas with lines over them: so much of the colour of a curve, the rest paper. The colours of
    /// the first curves come last.
    pub(crate) fn tint(&self, share: f64, number: usize) -> (u8, u8, u8) {
        const ORDER: [usize; 6] = [5, 6, 2, 3, 1, 0];
        if self.colours == ColourMap::Grey {
            // Greys are told apart by their lightness alone.
            let ink = 0.08 + 0.13 * (number % ORDER.len()) as f64;
            let (ground, letters) = (self.resolve(PAPER).0.0, self.resolve(INK).0.0);
            let grey = (ink * f64::from(letters) + (1.0 - ink) * f64::from(ground)).round() as u8;
            return (grey, grey, grey);
        }
        let own = Stroke::curve(ORDER[number % ORDER.len()]).colour;
        let ((r, g, b), paper) = (self.resolve(own).0, self.resolve(PAPER).0);
        let mix = |own: u8, paper: u8| {
            (share * f64::from(own) + (1.0 - share) * f64::from(paper)).round() as u8
        };
        (mix(r, paper.0), mix(g, paper.1), mix(b, paper.2))
    }

    /// A colour on this ground, and its opacity.
    pub(crate) fn resolve(&self, colour: Colour) -> ((u8, u8, u8), f64) {
        let rgb = if self.is_dark {
            colour.dark
        } else {
            colour.light
        };
        match self.colours {
            ColourMap::Grey => (grey(rgb), colour.alpha),
            _ => (rgb, colour.alpha),
        }
    }
}

/// The grey of the same luminance.
fn grey(rgb: (u8, u8, u8)) -> (u8, u8, u8) {
    let grey = (255.0 * luminance(rgb).powf(1.0 / 2.2)).round() as u8;
    (grey, grey, grey)
}

/// Black or white, whichever is seen better on the colour of a share (0 to 1) of the largest value.
pub(crate) fn on_heat(look: &Look, share: f64) -> Colour {
    let ground = luminance(look.colours.colour(look.along_colours(share)));
    // Against white the contrast is 3.3 to one here; thin white lines are seen better than thin black ones.
    if ground > 0.27 { BLACK } else { WHITE }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::style::FigureWidth;

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

    #[test]
    fn pages_are_as_wide_as_asked_for() {
        for width in FigureWidth::NAMED {
            let style = FigureStyle {
                width,
                ..FigureStyle::default()
            };
            assert!(style.has_room());
            let look = style.look();
            let given = look
                .page
                .map(|page| page * look.points / POINTS_A_MILLIMETRE);
            match (given, width.millimetres()) {
                (Some(page), Some(wanted)) => assert!((page - wanted).abs() < 1e-9),
                (page, wanted) => assert_eq!(page, wanted),
            }
            assert_eq!(width.name().and_then(FigureWidth::parse), Some(width));
        }
        let style = FigureStyle {
            width: FigureWidth::Millimetres(f64::INFINITY),
            text: Some(f64::NAN),
            ..FigureStyle::default()
        };
        assert!(!style.has_room() && style.look().page.is_some_and(f64::is_finite));
    }

    #[test]
    fn marks_on_heat_keep_a_contrast_of_three() {
        for colours in ColourMap::ALL {
            let look = Look {
                colours,
                ..Look::default()
            };
            for step in 0..=100 {
                let share = f64::from(step) / 100.0;
                let ground = luminance(colours.colour(share)) + 0.05;
                let mark = luminance(on_heat(&look, share).light) + 0.05;
                let contrast = (ground / mark).max(mark / ground);
                assert!(contrast > 3.0, "{share}: {contrast}");
            }
        }
    }
}
