//! The FMU file: a zip of the description, the shared libraries and the car's files.

use std::io::{self, Seek, Write};

use cvtcycle_config::setup::Setup;
use cvtcycle_config::setup::carried::CarriedCar;
use cvtcycle_output::BUILD;
use cvtcycle_output::files::{hex, sha256};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::UNIT_FILE;
use crate::description::{About, Fmi, documentation, model_description};
use crate::variables::{Kind, variables};

/// Platform of a shared library.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Platform {
    /// Linux on x86-64.
    Linux,
    /// Windows on x86-64.
    Windows,
}

impl Platform {
    /// All platforms.
    pub const ALL: [Platform; 2] = [Platform::Linux, Platform::Windows];

    /// Detects the platform of a library by magic number and processor: ELF (62 is x86-64) or PE (0x8664).
    #[must_use]
    pub fn detect(bytes: &[u8]) -> Option<Platform> {
        let word = |at: usize| Some([*bytes.get(at)?, *bytes.get(at + 1)?]);
        if bytes.starts_with(b"\x7fELF\x02\x01") {
            return (word(18)? == [62, 0]).then_some(Platform::Linux);
        }
        if !bytes.starts_with(b"MZ") {
            return None;
        }
        let header = bytes.get(0x3c..0x40)?.first_chunk::<4>()?;
        let header = u32::from_le_bytes(*header) as usize;
        let is_pe = bytes.get(header..)?.starts_with(b"PE\0\0");
        (is_pe && word(header + 4)? == [0x64, 0x86]).then_some(Platform::Windows)
    }

    /// Name for users.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Platform::Linux => "Linux on x86-64",
            Platform::Windows => "Windows on x86-64",
        }
    }

    /// File name as built by Cargo.
    #[must_use]
    pub fn library(self) -> &'static str {
        match self {
            Platform::Linux => "libcvtcycle_fmu.so",
            Platform::Windows => "cvtcycle_fmu.dll",
        }
    }

    /// Folder and extension in an FMU.
    fn place(self, fmi: Fmi) -> (&'static str, &'static str) {
        match (self, fmi) {
            (Platform::Linux, Fmi::Two) => ("linux64", "so"),
            (Platform::Windows, Fmi::Two) => ("win64", "dll"),
            (Platform::Linux, Fmi::Three) => ("x86_64-linux", "so"),
            (Platform::Windows, Fmi::Three) => ("x86_64-windows", "dll"),
        }
    }
}

/// Contents of an FMU.
#[derive(Debug)]
pub struct Package<'a> {
    /// Kind of unit.
    pub kind: Kind,
    /// Version of the standard.
    pub fmi: Fmi,
    /// The car.
    pub setup: &'a Setup,
    /// Files of the car.
    pub car: CarriedCar,
    /// Shared libraries.
    pub libraries: Vec<(Platform, Vec<u8>)>,
}

/// C identifier made of car and kind.
fn identifier(setup: &Setup, kind: Kind) -> String {
    let fits = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = setup.name.chars().map(fits).collect();
    let digit = name.starts_with(|c: char| c.is_ascii_digit());
    format!("{}{name}_{}", if digit { "_" } else { "" }, kind.name())
}

impl Package<'_> {
    /// Writes the FMU. Equal input gives equal bytes.
    /// # Errors
    /// Errors of `out`.
    pub fn write(self, out: impl Write + Seek) -> io::Result<()> {
        let variables = variables(self.kind, self.setup.transmission());
        let identifier = identifier(self.setup, self.kind);
        let files = self.car.into_files();
        let mut all = format!("{BUILD} {} {identifier}\n", self.kind.name()).into_bytes();
        for (name, bytes) in &files {
            all.extend(name.as_bytes());
            all.extend((bytes.len() as u64).to_le_bytes());
            all.extend(bytes);
        }
        let token = format!("{{{}}}", &hex(&sha256(&all))[..32]);
        let about = About {
            kind: self.kind,
            title: &self.setup.title,
            identifier: &identifier,
            token: &token,
        };
        let mut zip = ZipWriter::new(out);
        let mut put = |name: &str, bytes: &[u8]| {
            zip.start_file(name, SimpleFileOptions::default())
                .map_err(io::Error::from)?;
            zip.write_all(bytes)
        };
        let description = model_description(self.fmi, &about, &variables);
        put("modelDescription.xml", description.as_bytes())?;
        put(
            "documentation/index.html",
            documentation(&about, &variables).as_bytes(),
        )?;
        for (platform, bytes) in &self.libraries {
            let (folder, ending) = platform.place(self.fmi);
            put(&format!("binaries/{folder}/{identifier}.{ending}"), bytes)?;
        }
        let unit = format!("{} {token}\n", self.kind.name());
        put(&format!("resources/{UNIT_FILE}"), unit.as_bytes())?;
        for (name, bytes) in &files {
            put(&format!("resources/{name}"), bytes)?;
        }
        zip.finish().map_err(io::Error::from)?.flush()
    }
}
