//! What a sweep file says of figures in its section `[figures]`: where, which, in which formats and in what style.

use super::style::FigureStyle;

/// The figures that are wanted of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct FigureSettings {
    /// Parameter values at which densities are drawn.
    pub at: Vec<f64>,
    /// File formats.
    pub formats: Vec<Format>,
    /// Names, or the beginnings that several share; `None` for the usual ones.
    pub draw: Option<Vec<String>>,
    /// How figures look.
    pub style: FigureStyle,
}

impl Default for FigureSettings {
    /// The usual figures are known to programs that can draw.
    fn default() -> Self {
        Self {
            at: Vec::new(),
            formats: Format::USUAL.to_vec(),
            #[cfg(feature = "figures")]
            draw: Some(super::kinds::usual()),
            #[cfg(not(feature = "figures"))]
            draw: None,
            style: FigureStyle::default(),
        }
    }
}

impl FigureSettings {
    /// The names of the figures that are drawn, or the beginnings that several share.
    pub fn names(&self) -> &[String] {
        self.draw.as_deref().unwrap_or_default()
    }
}

/// File formats of figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Scalable vector graphics; heat maps are embedded pictures.
    Svg,
    /// Pixels, as many to the inch as the style says.
    Png,
    /// A page of the figure's size, with fonts embedded and text kept as text.
    Pdf,
    /// The numbers it was drawn from, as a table.
    Csv,
    /// Its caption, as plain text.
    Txt,
    /// Its caption, as LaTeX.
    Tex,
}

words! { Format, pub name: Svg: "svg", Png: "png", Pdf: "pdf", Csv: "csv", Txt: "txt", Tex: "tex" }

impl Format {
    /// Those that are written where none is named.
    pub const USUAL: [Self; 2] = [Self::Svg, Self::Png];
}
