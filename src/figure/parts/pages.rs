//! How a figure fits its page: panels become lower or higher, and where that is not enough some of them stand on
//! further pages.

use crate::figure::canvas::look::Look;
use crate::figure::print::{Figure, Print};

/// Panels become no lower than this share of their usual height while another page would help.
const LEAST: f64 = 0.72;
/// The same on a page of fixed height, where a page more is a slide more.
const LEAST_ON_SLIDES: f64 = 0.5;
/// The share where nothing else helps.
const LOWEST: f64 = 0.2;
/// On a page of fixed height panels become no higher than this multiple of their usual height.
const HIGHEST: f64 = 1.8;
/// Rounds in which the multiple is found: heights follow it nearly in proportion, but for rounding and labels.
const ROUNDS: usize = 5;
/// A page that is lower by less is full, in figure pixels.
const FULL: f64 = 1.0;

/// What draws a page of a figure; `None` where there is nothing to see.
type Draw<'a> = dyn Fn(&Print<'_>) -> Option<Figure> + Sync + 'a;

/// Draws a figure on as few pages as have room for it.
pub(crate) fn fitted(print: &Print<'_>, draw: &Draw<'_>) -> Vec<Figure> {
    let Some(whole) = draw(print) else {
        return Vec::new();
    };
    let (panels, look) = (whole.panels().max(1), &print.look);
    if whole.height() <= look.greatest_height && !look.has_fixed_height {
        return vec![whole];
    }
    let least = if look.has_fixed_height {
        LEAST_ON_SLIDES
    } else {
        LEAST
    };
    for pages in 1..panels {
        if let Some(drawn) = on_pages(print, draw, (pages, least)) {
            return drawn;
        }
    }
    on_pages(print, draw, (panels, LOWEST)).unwrap_or_default()
}

/// The figure on so many pages, all with panels of one height; `None` where these would be lower than a multiple of
/// their usual height.
fn on_pages(
    print: &Print<'_>,
    draw: &Draw<'_>,
    (pages, least): (usize, f64),
) -> Option<Vec<Figure>> {
    let page = |number: usize, tall: f64| {
        draw(&Print {
            look: Look { tall, ..print.look },
            part: (number, pages),
            solved_by: print.solved_by.clone(),
            modes: print.modes.clone(),
            ..*print
        })
    };
    let mut tall: f64 = HIGHEST;
    for number in 0..pages {
        tall = tall.min(multiple(&print.look, least, &|tall| page(number, tall))?);
    }
    let drawn: Option<Vec<Figure>> = (0..pages).map(|number| page(number, tall)).collect();
    let height = print.look.greatest_height;
    let drawn = drawn?.into_iter().map(|figure| {
        if print.look.has_fixed_height {
            figure.on_page(height)
        } else {
            figure
        }
    });
    Some(drawn.collect())
}

/// The multiple of the usual height of panels at which a page is as high as it may be; at most one where pages may be
/// lower.
fn multiple(look: &Look, least: f64, draw: &dyn Fn(f64) -> Option<Figure>) -> Option<f64> {
    let height = |tall: f64| draw(tall).map(|figure| figure.height());
    let most = look.greatest_height;
    let (mut low, mut high) = ((least, height(least)?), (1.0, height(1.0)?));
    if low.1 > most && least > LOWEST {
        return None;
    }
    if high.1 <= most && !look.has_fixed_height {
        return Some(1.0);
    }
    if high.1 <= most {
        (low, high) = (high, (HIGHEST, height(HIGHEST)?));
        if high.1 <= most {
            return Some(HIGHEST);
        }
    }
    // What fits is kept below, what does not above.
    for _ in 0..ROUNDS {
        if most - low.1 < FULL || high.1 <= low.1 {
            break;
        }
        let share = ((most - 0.5 * FULL - low.1) / (high.1 - low.1)).clamp(0.02, 0.98);
        let tall = low.0 + share * (high.0 - low.0);
        match height(tall)? {
            fits if fits <= most => low = (tall, fits),
            too_high => high = (tall, too_high),
        }
    }
    Some(low.0)
}
