//! Figures in every style: as wide as asked for, nothing cut off, no two texts on each other; PDF with its text and its
//! fonts.

use proptest::prelude::*;
use roxmltree::Document;

use pbif::continuation::{Label, Located, Measure, SweepResult};
use pbif::figure::{
    ColourMap, ColourScale, Figure, FigureStyle, FigureWidth, Figures, Ground, Typeface,
};

use crate::common::closed_forms::{bistable, rayleigh, uniform};
use crate::texts::{size, texts};

const TITLE: &str = "Duffing oscillator with Coulomb friction, sweep of the friction level";

fn drawn(result: &SweepResult, style: &FigureStyle) -> Vec<Figure> {
    let figures = Figures::of_sweep(result, TITLE, &[-0.5, 0.25, 1.0]);
    figures.with_style(style).draw_all()
}

/// No text leaves the page or touches another. Boxes reach from the lowest to the highest place of any letter of the
/// font: half of what they overlap in height is air.
fn assert_readable(figure: &Figure, style: &FigureStyle) {
    assert_texts_apart(figure, &Document::parse(&figure.svg()).unwrap(), style);
}

/// The same of a figure whose drawing is read already.
fn assert_texts_apart(figure: &Figure, svg: &Document<'_>, style: &FigureStyle) {
    let texts = texts(svg);
    let unit = style.text_points() / 10.5;
    let (name, (page, _)) = (&figure.name, size(svg));
    assert!(!texts.is_empty(), "{name} has no text");
    for (number, one) in texts.iter().enumerate() {
        let inside = one.left > -0.5 && one.right < page[0] + 0.5;
        assert!(
            inside && one.top > -0.5 && one.bottom < page[1] + 0.5,
            "{name}: `{}` leaves the page of {page:?}: {one:?} in {style:?}",
            one.letters
        );
        for other in &texts[..number] {
            let across = one.right.min(other.right) - one.left.max(other.left);
            let down = one.bottom.min(other.bottom) - one.top.max(other.top);
            assert!(
                across < unit || down < 6.0 * unit,
                "{name}: `{}` on `{}`, {across} by {down} in {style:?}",
                one.letters,
                other.letters
            );
        }
    }
}

/// The figure is readable and no higher than a page, and a slide is one of 16 to 9; its width, in millimetres. It is
/// written once for all of this: pictures in it take long.
fn assert_readable_on_a_page(figure: &Figure, style: &FigureStyle) -> f64 {
    let svg = figure.svg();
    let svg = Document::parse(&svg).unwrap();
    assert_texts_apart(figure, &svg, style);
    let ([wide, high], units) = size(&svg);
    let (name, most) = (&figure.name, style.width.greatest_height());
    let high = high * 25.4 / 96.0;
    // A canvas counts in twentieths of a figure pixel.
    assert!(high < most + 0.05, "{name} is {high} mm high in {style:?}");
    if style.width.has_fixed_height() {
        assert_eq!(9.0 * units[0], 16.0 * units[1], "{name}: {wide} by {high}");
    }
    wide * 25.4 / 96.0
}

/// A sweep of which more is watched, measured and drawn than has room on a page.
fn crowded() -> SweepResult {
    let mut result = rayleigh(("coulomb", "f_c"), 1.0, &uniform());
    for point in &mut result.points {
        for number in 0..17 {
            let value = (point.value * f64::from(number)).cos();
            point.report.measures.push(Measure {
                name: format!("mean_q{number}"),
                value,
                error: None,
                unit: "1".to_owned(),
            });
        }
    }
    result
}

#[test]
fn what_has_no_room_on_a_page_stands_on_several() {
    let result = crowded();
    let at: Vec<f64> = (0..7)
        .map(|number| -1.0 + 0.3 * f64::from(number))
        .collect();
    for width in FigureWidth::NAMED {
        let style = FigureStyle {
            width,
            ..FigureStyle::default()
        };
        let figures = Figures::of_sweep(&result, TITLE, &at).with_style(&style);
        // Figures of one value have one panel: these are read in every width by a test of their own.
        let drawn = figures.draw_named(&[
            "measures",
            "joint_sheets",
            "surface_sheets",
            "pairs_xy",
            "health",
        ]);
        let named = |name: &str| {
            drawn
                .iter()
                .filter(|figure| figure.name.starts_with(name))
                .count()
        };
        assert!(
            named("measures_") >= 17 && named("pairs_xy") >= 1,
            "{width:?}"
        );
        for figure in &drawn {
            assert_readable_on_a_page(figure, &style);
        }
        // Each page says which it is, and together they have every panel once.
        let pages: Vec<&Figure> = drawn
            .iter()
            .filter(|one| one.name.starts_with("pairs_xy"))
            .collect();
        for (number, page) in pages.iter().enumerate() {
            let says = format!(" Page {} of {}.", number + 1, pages.len());
            assert!(
                pages.len() == 1 || page.caption.contains(&says),
                "{}",
                page.caption
            );
        }
        let all: String = pages.iter().map(|page| page.svg()).collect();
        for letter in 'a'..='g' {
            assert_eq!(
                all.matches(&format!("({letter})")).count(),
                1,
                "{letter} in {width:?}"
            );
        }
    }
}

#[test]
fn grey_is_grey_everywhere() {
    let style = FigureStyle {
        width: FigureWidth::Single,
        colours: ColourMap::Grey,
        ..FigureStyle::default()
    };
    for result in [bistable(), rayleigh(("coulomb", "f_c"), 1.0, &uniform())] {
        for figure in drawn(&result, &style) {
            let png = figure.png().unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(&png))
                .read_info()
                .unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            let is_grey = |rgb: &[u8]| rgb[0] == rgb[1] && rgb[1] == rgb[2];
            assert!(pixels.chunks(3).all(is_grey), "{} has colours", figure.name);
        }
    }
}

#[test]
fn a_single_map_is_a_square_in_every_style() {
    let result = rayleigh(("coulomb", "f_c"), 1.0, &uniform());
    for width in FigureWidth::NAMED {
        let style = FigureStyle {
            width,
            ..FigureStyle::default()
        };
        let figures = Figures::of_sweep(&result, TITLE, &[-0.5]).with_style(&style);
        let map = figures.draw("joint_xy_-0.5").unwrap().remove(0);
        assert_readable(&map, &style);
        let svg = map.svg();
        let svg = Document::parse(&svg).unwrap();
        let mut images = svg.descendants().filter(|one| one.has_tag_name("image"));
        let image = images.next().unwrap();
        let [wide, high] = ["width", "height"].map(|name| {
            let length: f64 = image.attribute(name).unwrap().parse().unwrap();
            length
        });
        assert!(
            (wide / high - 1.0).abs() < 2e-3,
            "{width:?}: {wide} by {high}"
        );
    }
}

#[test]
fn maps_on_a_sheet_are_squares_too() {
    let result = rayleigh(("coulomb", "f_c"), 1.0, &uniform());
    let pages = FigureWidth::NAMED.into_iter();
    for width in pages.filter(|width| !width.has_fixed_height()) {
        let style = FigureStyle {
            width,
            ..FigureStyle::default()
        };
        let figures = Figures::of_sweep(&result, TITLE, &[-0.5, 0.25, 0.5, 1.0]);
        for sheet in figures.with_style(&style).draw("joint_xy").unwrap() {
            let svg = sheet.svg();
            let svg = Document::parse(&svg).unwrap();
            let images = svg.descendants().filter(|one| one.has_tag_name("image"));
            let sizes = images.map(|image| {
                ["width", "height"]
                    .map(|name| image.attribute(name).unwrap().parse::<f64>().unwrap())
            });
            // The colour bar is a picture of its own, and no square.
            let squares = sizes.filter(|[wide, high]| (wide / high - 1.0).abs() < 2e-2);
            assert_eq!(squares.count(), 4, "{width:?}");
        }
    }
}

#[test]
fn logarithmic_colours_tell_their_floor() {
    let style = FigureStyle {
        scale: ColourScale::Log,
        ..FigureStyle::default()
    };
    let result = rayleigh(("coulomb", "f_c"), 1.0, &uniform());
    let figures = Figures::of_sweep(&result, TITLE, &[-0.5, 1.0]).with_style(&style);
    for figure in figures.draw_named(&["diagram", "joint", "pairs"]) {
        assert_readable(&figure, &style);
        assert!(
            figure.caption.contains("below 10^-4 of the largest"),
            "{}",
            figure.caption
        );
    }
}

#[test]
fn every_figure_reads_in_every_named_width() {
    let (bistable, rayleigh) = (bistable(), rayleigh(("coulomb", "f_c"), 1.0, &uniform()));
    for (number, width) in FigureWidth::NAMED.into_iter().enumerate() {
        let style = FigureStyle {
            width,
            font: Typeface::ALL[number % 2],
            ground: Ground::ALL[number / 2 % 2],
            colours: ColourMap::ALL[number % 4],
            ..FigureStyle::default()
        };
        for result in [&bistable, &rayleigh] {
            for figure in drawn(result, &style) {
                let given = assert_readable_on_a_page(&figure, &style);
                if let Some(width) = width.millimetres() {
                    // A canvas counts in twentieths of a figure pixel.
                    assert!((given - width).abs() < 0.05, "{}: {given}", figure.name);
                }
            }
        }
    }
}

/// Gives a sweep so many labelled changes, close to each other where there are many, of its observables by turns.
fn with_labels(result: &mut SweepResult, count: usize) {
    let Some(row) = result.bifurcations().next().cloned() else {
        return;
    };
    let (from, to) = (
        result.points[0].value,
        result.points[result.points.len() - 1].value,
    );
    result.labels.retain(|row| row.bifurcation().is_none());
    result.labels.extend((0..count).map(|number| {
        let value = from + (to - from) * (number as f64 / count as f64).powi(3);
        let observables = &result.subject.observables;
        Label::Bifurcation(Box::new(Located {
            label: format!("PB{}", number + 1),
            value,
            lower: value,
            upper: value,
            observable: observables[number % observables.len()],
            ..row.clone()
        }))
    }));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, ..ProptestConfig::default() })]

    #[test]
    fn figures_read_at_any_size(width in 60.0..400.0f64, share in 0.0..1.0f64, scale in -3.0..3.0f64, count in 0..14usize) {
        // Text from the smallest allowed to the largest that has room.
        let largest = FigureStyle { text: Some(1.0), ..FigureStyle::default() };
        let most = (width / largest.widths().0).min(40.0);
        let style = FigureStyle {
            width: FigureWidth::Millimetres(width),
            text: Some(4.0 + share * (most - 4.0).max(0.0) * 0.999),
            ..FigureStyle::default()
        };
        if style.has_room() {
            let spread = 10f64.powf(scale);
            let mut result = rayleigh(("rayleigh", "a"), spread, &uniform());
            with_labels(&mut result, count);
            for figure in drawn(&result, &style) {
                assert_readable(&figure, &style);
            }
        }
    }
}

#[test]
fn a_pdf_has_the_size_its_fonts_and_is_the_same_each_time() {
    let style = FigureStyle {
        width: FigureWidth::Single,
        ..FigureStyle::default()
    };
    let result = rayleigh(("rayleigh", "a"), 1.0, &uniform());
    for figure in drawn(&result, &style) {
        if !["diagram_x", "surface_xy", "marginals"]
            .iter()
            .any(|word| figure.name.starts_with(word))
        {
            continue;
        }
        let pdf = figure.pdf();
        assert_eq!(pdf, figure.pdf());
        assert!(pdf.starts_with(b"%PDF-") && pdf.len() < 1_000_000);
        let text = String::from_utf8_lossy(&pdf);
        assert!(
            text.contains("DejaVuSans") && text.contains("/FontFile2"),
            "{}",
            figure.name
        );
        let size = text.split("/MediaBox").nth(1).unwrap();
        let numbers: Vec<f64> = size
            .split(|c: char| !(c.is_ascii_digit() || c == '.'))
            .filter_map(|number| number.parse().ok())
            .take(4)
            .collect();
        assert!(
            (numbers[2] / 72.0 * 25.4 - 84.0).abs() < 0.05,
            "{numbers:?}"
        );
    }
}

#[test]
fn the_text_of_a_pdf_is_found() {
    if std::process::Command::new("pdftotext")
        .arg("-v")
        .output()
        .is_err()
    {
        eprintln!("skipped: pdftotext (of poppler-utils) is not installed");
        return;
    }
    let style = FigureStyle {
        width: FigureWidth::Double,
        ..FigureStyle::default()
    };
    let result = rayleigh(("rayleigh", "a"), 1.0, &uniform());
    let folder = tempfile::tempdir().unwrap();
    for (figure, words) in [
        ("diagram_x", ["peak", "valley"]),
        ("marginals", ["p(x)", "p(ẋ)"]),
        ("surface_xy", ["p(x, ẋ)", "x"]),
    ] {
        let drawn = drawn(&result, &style);
        let one = drawn
            .iter()
            .find(|one| one.name.starts_with(figure))
            .unwrap();
        let file = folder.path().join("figure.pdf");
        std::fs::write(&file, one.pdf()).unwrap();
        let output = std::process::Command::new("pdftotext")
            .arg(&file)
            .arg("-")
            .output();
        let text = String::from_utf8(output.unwrap().stdout).unwrap();
        // Letters come composed or not, and lines where the reader puts them.
        let plain = |text: &str| {
            text.replace("x\u{307}", "ẋ")
                .split_whitespace()
                .collect::<String>()
        };
        for word in words {
            assert!(
                plain(&text).contains(&plain(word)),
                "{figure}: no `{word}` in {text:?}"
            );
        }
    }
}

#[test]
fn a_png_says_its_resolution() {
    let style = FigureStyle {
        width: FigureWidth::Single,
        dpi: 150.0,
        ..FigureStyle::default()
    };
    let figures = drawn(&bistable(), &style);
    let png = figures[0].png().unwrap();
    let reader = png::Decoder::new(std::io::Cursor::new(&png))
        .read_info()
        .unwrap();
    let dimensions = reader.info().pixel_dims.unwrap();
    assert_eq!(dimensions.xppu, (150.0f64 / 0.0254).round() as u32);
    assert_eq!(reader.info().width, (84.0f64 / 25.4 * 150.0).round() as u32);
}
