//! What a file asks of the relaxation to the steady state.

use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, MethodKind};
use crate::sweep_file::reader::Reader;

/// How many slow modes are wanted; 0 for none. They are eigenvalues of the generator, which the other methods do not
/// have.
pub(super) fn read(reader: &mut Reader<'_>, draft: &Draft) -> usize {
    let Some(wanted) = draft.slow_modes else {
        return 0;
    };
    if draft.method.kind != MethodKind::Generator {
        let name = draft.method.kind.name();
        let title = format!("slow modes are worked out by `generator`, not by `{name}`");
        let remedy = "set `method.kind = \"generator\"`, or leave `[relaxation]` out";
        let diagnostic = Diagnostic::new(title).remedy(remedy);
        let place = reader.key_place(&["relaxation", "modes"]);
        reader.report(diagnostic.at(place, "this number"));
    }
    wanted
}
