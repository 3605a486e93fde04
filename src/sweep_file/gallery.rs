//! Starting files: the gallery of systems from the literature, compiled in so that `pbif new` needs no folder.

/// A sweep file that runs as it stands, with comments for whoever changes it.
#[derive(Debug, Clone, Copy)]
pub struct StartingFile {
    /// Name, that of the file in `sweeps/gallery/` without its ending.
    pub name: &'static str,
    /// The sweep file.
    pub text: &'static str,
}

impl StartingFile {
    /// What the system is, in a few words.
    pub fn title(&self) -> &'static str {
        let lines = self.text.lines();
        let mut titles = lines.filter_map(|line| line.strip_prefix("title = \""));
        titles
            .next()
            .map_or("", |title| title.trim_end_matches('"'))
    }

    /// Whether it runs the built-in model of that name.
    pub(crate) fn is_of_model(&self, name: &str) -> bool {
        let model = format!("model = \"{name}\"");
        self.text.lines().any(|line| line.starts_with(&model))
    }
}

/// One entry a file of `sweeps/gallery/`.
macro_rules! files {
    ($($name:literal),+ $(,)?) => {
        &[$(StartingFile {
            name: $name,
            text: include_str!(concat!("../../sweeps/gallery/", $name, ".toml")),
        }),+]
    };
}

/// All starting files, in the order in which they are listed.
pub fn starting_files() -> &'static [StartingFile] {
    files!(
        "vanderpol",
        "rayleigh",
        "peak_and_ring",
        "laser",
        "duffing_vanderpol",
        "duffing_vanderpol_parametric",
        "duffing_vanderpol_stability",
        "double_well_spectrum",
        "galloping",
        "ship_roll",
        "capsizing",
        "harvester",
        "verhulst",
        "genetic",
        "schloegl",
        "toggle",
        "switching",
        "fitzhugh_nagumo",
        "stick_slip",
        "lugre",
        "elasto_plastic",
        "bouc_wen",
        "bliman_sorine",
        "coloured_bistable",
        "stochastic_resonance",
        "forced_duffing",
        "mathieu",
        "pendulum",
        "phase_locked_loop",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep_file::SweepFile;

    /// Every file of the folder is listed, and is right as it stands.
    #[test]
    fn starting_files_are_the_gallery() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/sweeps/gallery");
        let entries = std::fs::read_dir(folder).unwrap();
        let in_folder = entries.map(|entry| entry.unwrap().path());
        let mut in_folder: Vec<String> = in_folder
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        in_folder.sort();
        let mut listed: Vec<&str> = starting_files().iter().map(|file| file.name).collect();
        listed.sort_unstable();
        assert_eq!(listed, in_folder);
        for file in starting_files() {
            let read = SweepFile::parse(file.name, file.text).validate().unwrap();
            assert!(read.warnings.is_empty(), "{}", read.warnings);
            assert!(!file.title().is_empty(), "{}", file.name);
            let model = read.family.model();
            assert!(model.typed().is_none() || model.title == file.title());
            assert!(file.text.contains("# Source: "), "{}", file.name);
        }
    }
}
