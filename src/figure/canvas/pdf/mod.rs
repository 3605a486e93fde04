//! A drawing as a PDF of one page (ISO 32000-1): the numbers of its content are those of the SVG, fonts are embedded,
//! text is text. To programs that read it aloud it is one figure with its caption.

mod content;
mod font;
mod subset;

use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::StructRole;
use pdf_writer::writers::{ExtGraphicsState, StructTreeRoot};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::drawing::Drawing;
use super::heat::Picture;
use content::{Writer, name};

/// A drawing as a PDF of one page, in its size. `title` is what a reader shows above its window, `caption` what it
/// tells of the figure. Equal drawings give equal bytes.
pub(crate) fn pdf(drawing: &Drawing, title: &str, caption: &str) -> Vec<u8> {
    let points = drawing.points() as f32;
    let size = [drawing.size.0, drawing.size.1].map(|units| points * units as f32);
    let place = [points, 0.0, 0.0, -points, 0.0, size[1]];
    let (content, refers) = Writer::write(drawing, place);
    let mut file = Pdf::new();
    let mut free = Ref::new(1);
    let [pages, page, contents] = std::array::from_fn(|_| free.bump());
    file.stream(contents, &deflated(&content))
        .filter(Filter::FlateDecode);
    file.pages(pages).kids([page]).count(1);
    let objects = Objects::write(&mut file, &mut free, &refers);
    let mut one = file.page(page);
    let box_of_all = Rect::new(0.0, 0.0, size[0], size[1]);
    one.parent(pages)
        .media_box(box_of_all)
        .contents(contents)
        .struct_parents(0);
    objects.list(&mut one.resources());
    one.finish();
    let root = figure(&mut file, &mut free, page, (title, caption));
    let creator = format!("pbif {}", env!("CARGO_PKG_VERSION"));
    let mut info = file.document_info(free.bump());
    info.title(TextStr(title))
        .subject(TextStr(caption))
        .creator(TextStr(&creator));
    info.finish();
    let mut all = file.catalog(free.bump());
    all.pages(pages)
        .lang(TextStr("en"))
        .pair(Name(b"StructTreeRoot"), root);
    all.viewer_preferences().display_doc_title(true);
    all.mark_info().marked(true);
    all.finish();
    file.finish()
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    compress_to_vec_zlib(bytes, 9)
}

/// What the content of a page refers to, by its names.
struct Objects {
    fonts: Vec<(String, Ref)>,
    pictures: Vec<(String, Ref)>,
    opacities: Vec<(String, f32)>,
}

impl Objects {
    fn write(file: &mut Pdf, free: &mut Ref, refers: &Writer<'_>) -> Self {
        let mut fonts = Vec::new();
        for (&font, letters) in &refers.fonts {
            fonts.push((
                name('F', font as usize),
                font::write(file, free, font, letters),
            ));
        }
        let mut pictures = Vec::new();
        for (number, one) in refers.pictures.iter().enumerate() {
            pictures.push((name('P', number), picture(file, free.bump(), one)));
        }
        let opacities = refers.opacities.iter().enumerate();
        let opacities = opacities.map(|(number, &alpha)| (name('O', number), alpha as f32));
        Self {
            fonts,
            pictures,
            opacities: opacities.collect(),
        }
    }

    /// Lists them on their page.
    fn list(&self, resources: &mut pdf_writer::writers::Resources<'_>) {
        let pairs = |list: &[(String, Ref)], mut names: pdf_writer::Dict<'_>| {
            for (name, id) in list {
                names.pair(Name(name.as_bytes()), id);
            }
        };
        pairs(&self.fonts, resources.fonts());
        pairs(&self.pictures, resources.x_objects());
        let mut states = resources.ext_g_states();
        for (name, alpha) in &self.opacities {
            let mut state = states
                .insert(Name(name.as_bytes()))
                .start::<ExtGraphicsState<'_>>();
            state.non_stroking_alpha(*alpha).stroking_alpha(*alpha);
        }
    }
}

/// Writes a picture, its pixels left crisp, those without a value transparent.
fn picture(file: &mut Pdf, id: Ref, picture: &Picture) -> Ref {
    let numbers = deflated(&picture.numbers);
    let colours: Vec<u8> = picture
        .palette
        .iter()
        .flat_map(|&[r, g, b, _]| [r, g, b])
        .collect();
    let mut image = file.image_xobject(id, &numbers);
    image.filter(Filter::FlateDecode);
    image
        .width(picture.size.0 as i32)
        .height(picture.size.1 as i32)
        .bits_per_component(8);
    let last = picture.palette.len().saturating_sub(1) as i32;
    image
        .color_space()
        .indexed(Name(b"DeviceRGB"), last, &colours);
    if let Some(clear) = picture.palette.iter().position(|colour| colour[3] == 0) {
        image.color_mask([clear as i32; 2]);
    }
    id
}

/// Writes what is on a page as a tree for programs that read it aloud: a document with one figure, its name and its
/// caption. Returns the root.
fn figure(file: &mut Pdf, free: &mut Ref, page: Ref, (title, caption): (&str, &str)) -> Ref {
    let [root, document, figure, marked] = std::array::from_fn(|_| free.bump());
    let mut tree = file.indirect(root).start::<StructTreeRoot<'_>>();
    tree.child(document).parent_tree().nums().insert(0, marked);
    tree.finish();
    file.indirect(marked).array().item(figure);
    file.struct_element(document)
        .kind(StructRole::Document)
        .parent(root)
        .child(figure);
    let mut one = file.struct_element(figure);
    one.kind(StructRole::Figure).parent(document).page(page);
    one.title(TextStr(title)).alt(TextStr(caption));
    one.children().marked_content_id(0);
    root
}
