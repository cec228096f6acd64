//! Settings of the transmission rig, as data with a status: `rigs/rig_transmission.toml`.

use cvtcycle_model::rig::transmission::Conditions;
pub use cvtcycle_model::rig::transmission::{OIL, TORQUE};

use crate::files::embedded;
use crate::{Document, KeyInfo, Override, Problems, Reader, Section, Target};

/// The embedded conditions with overrides; of `set` only those of the rig count.
///
/// # Errors
/// All problems of the overrides, and of the file.
///
/// ```
/// use cvtcycle_config::{Override, rig};
/// let (conditions, _) = rig::load(&[Override::number("rig.ratio.high", 0.45)])?;
/// assert_eq!(conditions.high_ratio, 0.45);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn load(set: &[Override]) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
    let (name, text) = embedded::rigs()[0];
    let mut document = Document::parse(&format!("embedded:{name}.toml"), text)?;
    let own = set.iter().filter(|by| by.target() == Target::Rig);
    let mut problems: Problems = own.filter_map(|by| document.set(by).err()).collect();
    let reader = Reader::new(&document);
    let conditions = read(&reader.root());
    match reader.finish() {
        Ok(keys) if problems.is_empty() => Ok((conditions, keys)),
        read => {
            problems.extend(read.err().unwrap_or_default());
            Err(problems)
        }
    }
}

/// Reads the keys of a rig file.
#[must_use]
pub fn read(root: &Section) -> Conditions {
    Conditions::from_values(root)
}
