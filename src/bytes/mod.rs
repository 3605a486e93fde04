//! Numbers and lists as bytes and back, the same to the bit: for what a program keeps for itself, such as the state of
//! unfinished work. Tables and arrays that others read are written by [`run`](crate::run).

/// Something that was not written by a [`Writer`] in this order, or is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the bytes are not what was written")]
pub struct NotWhatWasWritten;

/// Puts values behind each other.
#[derive(Debug, Default)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Nothing yet, in the memory of bytes that are no longer needed.
    pub fn after(mut bytes: Vec<u8>) -> Self {
        bytes.clear();
        Self(bytes)
    }

    /// A whole number.
    pub fn count(&mut self, count: usize) -> &mut Self {
        self.0.extend((count as u64).to_le_bytes());
        self
    }

    /// A number, by its bits.
    pub fn number(&mut self, number: f64) -> &mut Self {
        self.0.extend(number.to_bits().to_le_bytes());
        self
    }

    /// A number that may be missing.
    pub fn optional(&mut self, number: Option<f64>) -> &mut Self {
        self.flag(number.is_some()).number(number.unwrap_or(0.0))
    }

    /// Yes or no.
    pub fn flag(&mut self, flag: bool) -> &mut Self {
        self.0.push(u8::from(flag));
        self
    }

    /// A list of numbers.
    pub fn numbers(&mut self, numbers: &[f64]) -> &mut Self {
        self.count(numbers.len());
        self.0.reserve(8 * numbers.len());
        for number in numbers {
            self.0.extend(number.to_bits().to_le_bytes());
        }
        self
    }

    /// A list of bytes.
    pub fn bytes(&mut self, bytes: &[u8]) -> &mut Self {
        self.count(bytes.len());
        self.0.extend(bytes);
        self
    }

    /// A text.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.bytes(text.as_bytes())
    }

    /// All of it.
    pub fn finish(self) -> Vec<u8> {
        self.0
    }
}

/// Takes values in the order in which they were written. Whatever the bytes are, no more memory is taken than they
/// have.
#[derive(Debug)]
pub struct Reader<'b>(&'b [u8]);

impl<'b> Reader<'b> {
    /// Reads from the beginning.
    pub fn new(bytes: &'b [u8]) -> Self {
        Self(bytes)
    }

    fn take(&mut self, length: usize) -> Result<&'b [u8], NotWhatWasWritten> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or(NotWhatWasWritten)?;
        self.0 = rest;
        Ok(taken)
    }

    fn word(&mut self) -> Result<u64, NotWhatWasWritten> {
        let bytes = self.take(8)?;
        Ok(u64::from_le_bytes(
            bytes.try_into().map_err(|_| NotWhatWasWritten)?,
        ))
    }

    /// A whole number.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`], as of all others.
    pub fn count(&mut self) -> Result<usize, NotWhatWasWritten> {
        usize::try_from(self.word()?).map_err(|_| NotWhatWasWritten)
    }

    /// A number.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn number(&mut self) -> Result<f64, NotWhatWasWritten> {
        Ok(f64::from_bits(self.word()?))
    }

    /// A number that may be missing.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn optional(&mut self) -> Result<Option<f64>, NotWhatWasWritten> {
        let there = self.flag()?;
        let number = self.number()?;
        Ok(there.then_some(number))
    }

    /// Yes or no.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn flag(&mut self) -> Result<bool, NotWhatWasWritten> {
        match self.take(1)? {
            [0] => Ok(false),
            [1] => Ok(true),
            _ => Err(NotWhatWasWritten),
        }
    }

    /// A list of numbers.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn numbers(&mut self) -> Result<Vec<f64>, NotWhatWasWritten> {
        let length = self.count()?.checked_mul(8).ok_or(NotWhatWasWritten)?;
        let (words, _) = self.take(length)?.as_chunks::<8>();
        Ok(words.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }

    /// A list of bytes.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn bytes(&mut self) -> Result<&'b [u8], NotWhatWasWritten> {
        let length = self.count()?;
        self.take(length)
    }

    /// A text.
    ///
    /// # Errors
    /// [`NotWhatWasWritten`].
    pub fn text(&mut self) -> Result<&'b str, NotWhatWasWritten> {
        std::str::from_utf8(self.bytes()?).map_err(|_| NotWhatWasWritten)
    }

    /// Whether everything was read.
    pub fn is_at_end(&self) -> bool {
        self.0.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn values_come_back_bit_for_bit(
            bits in proptest::collection::vec(any::<u64>(), 0..9), text in ".*", flag: bool
        ) {
            let numbers: Vec<f64> = bits.iter().map(|&bits| f64::from_bits(bits)).collect();
            let mut writer = Writer::new();
            writer.numbers(&numbers).flag(flag).text(&text).optional(None).count(bits.len());
            let bytes = writer.finish();
            let mut reader = Reader::new(&bytes);
            let back: Vec<u64> = reader.numbers().unwrap().iter().map(|n| n.to_bits()).collect();
            prop_assert_eq!(back, bits.clone());
            prop_assert_eq!(reader.flag(), Ok(flag));
            prop_assert_eq!(reader.text(), Ok(text.as_str()));
            prop_assert_eq!(reader.optional(), Ok(None));
            prop_assert_eq!(reader.count(), Ok(bits.len()));
            prop_assert!(reader.is_at_end());
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            let mut reader = Reader::new(&bytes);
            while !reader.is_at_end() {
                if reader.numbers().is_err() || reader.text().is_err() || reader.flag().is_err() {
                    break;
                }
            }
        }
    }
}
