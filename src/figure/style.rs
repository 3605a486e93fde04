//! The style of figures: the size a journal asks for, lettering, lines, colours.

/// Points in a millimetre.
pub(super) const POINTS_A_MILLIMETRE: f64 = 72.0 / 25.4;
/// Size of axis titles where a figure has its own width, in points.
pub(super) const TEXT_OF_OWN_WIDTH: f64 = 10.5;
/// The same where a width is given: what journals ask for.
const TEXT_OF_JOURNALS: f64 = 8.0;
/// The same on slides.
const TEXT_OF_SLIDES: f64 = 18.0;
/// The greatest height of a figure, in millimetres: a page of a journal with room for a caption.
const HEIGHT: f64 = 234.0;
/// Width and height of a slide, in millimetres: 16 to 9.
const SLIDE: (f64, f64) = (254.0, 254.0 * 9.0 / 16.0);
/// The narrowest page that every figure can be laid out on, in sizes of its text.
pub(super) const LEAST_WIDTH: f64 = 22.0;
/// The widest, in the same unit.
pub(super) const MOST_WIDTH: f64 = 200.0;

/// How wide figures are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum FigureWidth {
    /// Each figure as wide as its content takes, about 130 to 170 mm.
    #[default]
    Own,
    /// One column of a journal: 84 mm.
    Single,
    /// One and a half columns: 129 mm.
    OneAndAHalf,
    /// Two columns: 174 mm.
    Double,
    /// A slide: 254 mm by 142.9 mm, 16 to 9, with lettering for a room.
    Slide,
    /// So many millimetres.
    Millimetres(f64),
}

impl FigureWidth {
    /// Those that have a name.
    pub const NAMED: [Self; 5] = [
        Self::Own,
        Self::Single,
        Self::OneAndAHalf,
        Self::Double,
        Self::Slide,
    ];

    /// Name used in sweep files; `None` for millimetres.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Own => Some("own"),
            Self::Single => Some("single"),
            Self::OneAndAHalf => Some("one-and-a-half"),
            Self::Double => Some("double"),
            Self::Slide => Some("slide"),
            Self::Millimetres(_) => None,
        }
    }

    /// The width of that name.
    pub(crate) fn parse(name: &str) -> Option<Self> {
        Self::NAMED
            .into_iter()
            .find(|width| width.name() == Some(name))
    }

    /// In millimetres; `None` where every figure has its own.
    pub fn millimetres(self) -> Option<f64> {
        match self {
            Self::Own => None,
            Self::Single => Some(84.0),
            Self::OneAndAHalf => Some(129.0),
            Self::Double => Some(174.0),
            Self::Slide => Some(SLIDE.0),
            Self::Millimetres(width) => Some(width),
        }
    }

    /// The greatest height of a figure, in millimetres. Panels that have no room on such a page flow into columns, then
    /// onto further pages.
    pub fn greatest_height(self) -> f64 {
        match self {
            Self::Slide => SLIDE.1,
            _ => HEIGHT,
        }
    }

    /// Whether every figure is as high as that.
    pub fn has_fixed_height(self) -> bool {
        self == Self::Slide
    }
}

/// The ground figures stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Ground {
    /// White, for print.
    #[default]
    Light,
    /// Nearly black, for screens.
    Dark,
}

words! { Ground, pub name: Light: "light", Dark: "dark" }

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

words! { ColourMap, pub name: Viridis: "viridis", Cividis: "cividis", Magma: "magma", Grey: "grey" }

/// How colours of heat maps follow the density.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum ColourScale {
    /// In proportion.
    #[default]
    Linear,
    /// By decades, four of them below the largest density: for tails. What is lower has the colour of the floor.
    Log,
}

words! { ColourScale, pub name: Linear: "linear", Log: "log" }

/// The typeface: one family each, which comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Typeface {
    /// DejaVu Sans.
    #[default]
    Sans,
    /// DejaVu Serif.
    Serif,
}

words! { Typeface, pub name: Sans: "sans", Serif: "serif" }

/// How figures look. The default is a figure for the screen; with a width it is one for a journal.
///
/// ```
/// use pbif::figure::{FigureStyle, FigureWidth};
///
/// let column = FigureStyle { width: FigureWidth::Single, ..FigureStyle::default() };
/// assert_eq!(column.text_points(), 8.0);
/// assert!(column.has_room());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureStyle {
    /// Width of every figure; panels, ticks and legends are laid out for it.
    pub width: FigureWidth,
    /// Size of axis titles in points, of tick labels nine tenths of it; `None` for 8 where a width is given, 18 on
    /// slides, else 10.5.
    pub text: Option<f64>,
    /// Width of curves in points, other lines in proportion; `None` for a width that suits the text.
    pub line: Option<f64>,
    /// Pixels of a PNG to the inch, which is written into the file.
    pub dpi: f64,
    /// The typeface.
    pub font: Typeface,
    /// Colours of maps and surfaces.
    pub colours: ColourMap,
    /// Whether colours of heat maps are linear or logarithmic in the density.
    pub scale: ColourScale,
    /// Light or dark ground.
    pub ground: Ground,
    /// Whether the title of the run stands above each figure.
    pub title: bool,
    /// Whether panels of a sheet have letters.
    pub letters: bool,
}

impl Default for FigureStyle {
    fn default() -> Self {
        Self {
            width: FigureWidth::default(),
            text: None,
            line: None,
            dpi: 288.0,
            font: Typeface::default(),
            colours: ColourMap::default(),
            scale: ColourScale::default(),
            ground: Ground::default(),
            title: true,
            letters: true,
        }
    }
}

impl FigureStyle {
    /// Size of axis titles, in points.
    pub fn text_points(&self) -> f64 {
        self.text.unwrap_or(match self.width {
            FigureWidth::Own => TEXT_OF_OWN_WIDTH,
            FigureWidth::Slide => TEXT_OF_SLIDES,
            _ => TEXT_OF_JOURNALS,
        })
    }

    /// The widths at which text of this size and a figure around it both have room, in millimetres.
    pub fn widths(&self) -> (f64, f64) {
        let text = self.text_points() / POINTS_A_MILLIMETRE;
        (LEAST_WIDTH * text, MOST_WIDTH * text)
    }

    /// Whether the width lies within [`FigureStyle::widths`]. Outside of them figures are drawn at the nearest of the
    /// two.
    pub fn has_room(&self) -> bool {
        let (least, most) = self.widths();
        self.width
            .millimetres()
            .is_none_or(|width| (least..=most).contains(&width))
    }
}
