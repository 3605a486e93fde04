//! A solve with what was asked of it, as bytes and back.

use super::record::Record;
use super::replay::Stored;
use crate::bytes::{NotWhatWasWritten, Reader, Writer};
use crate::system::Family;

/// How densities answer to a parameter, or what was said instead.
pub(super) type Answer = Result<Vec<Vec<f64>>, String>;

/// A solve with what was asked of it: by the name of a parameter, or nothing for the coordinate of the path.
#[derive(Debug)]
pub(super) struct Asked {
    pub(super) record: Record,
    /// Whether the solution could be asked.
    pub(super) answers_questions: bool,
    pub(super) answers: Vec<(String, Answer)>,
}

impl Asked {
    pub(super) fn write(&self, writer: &mut Writer, family: &Family) {
        self.record.write(writer, family);
        writer.flag(self.answers_questions);
        writer.count(self.answers.len());
        for (name, answer) in &self.answers {
            writer.text(name).flag(answer.is_ok());
            match answer {
                Ok(densities) => {
                    writer.count(densities.len());
                    for density in densities {
                        writer.numbers(density);
                    }
                }
                Err(words) => {
                    writer.text(words);
                }
            }
        }
    }

    pub(super) fn read(
        reader: &mut Reader<'_>,
        family: &Family,
        methods: &[&'static str],
    ) -> Result<Self, NotWhatWasWritten> {
        let record = Record::read(reader, family, methods)?;
        let answers_questions = reader.flag()?;
        let mut answers = Vec::new();
        for _ in 0..reader.count()? {
            let name = reader.text()?.to_owned();
            let answer = match reader.flag()? {
                true => {
                    let mut densities = Vec::new();
                    for _ in 0..reader.count()? {
                        densities.push(reader.numbers()?);
                    }
                    Ok(densities)
                }
                false => Err(reader.text()?.to_owned()),
            };
            answers.push((name, answer));
        }
        Ok(Self {
            record,
            answers_questions,
            answers,
        })
    }
}

impl Stored for Asked {
    fn record(&mut self) -> &mut Record {
        &mut self.record
    }
}
