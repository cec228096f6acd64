//! Repairs of a log, by their names.

use std::fmt;

use crate::{Argument, Problem};

macro_rules! repairs {
    ($($name:ident $word:literal $default:literal $what:literal;)*) => {
        /// Repairs that are wanted.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub struct Repairs {
            $(#[doc = $what] pub $name: bool,)*
        }

        impl Default for Repairs {
            fn default() -> Self {
                Repairs { $($name: $default,)* }
            }
        }

        impl Repairs {
            /// Name, default and meaning of each.
            pub const ALL: &'static [(&'static str, bool, &'static str)] = &[$(($word, $default, $what)),*];

            /// None.
            pub const NONE: Repairs = Repairs { $($name: false,)* };

            fn set(&mut self, word: &str, on: bool) -> bool {
                match word {
                    $($word => self.$name = on,)*
                    _ => return false,
                }
                true
            }
        }
    };
}

repairs! {
    empty "empty" true "rows without a time or a speed, as where channels have their own rasters, are left out";
    stamps "stamps" true "rows of one time stamp become one with their mean";
    negative "negative" true "speeds from -1 to 0 km/h become 0";
    spikes "spikes" true "up to 3 samples against both neighbours, or a loss of the signal of up to 10 s, become the line between these";
    held "held" true "rows that repeat a value until the next one is measured become the line between the values";
    smooth "smooth" true "speeds whose resolution or noise is coarse for their rate are smoothed";
    sort "sort" false "rows are put in the order of their times";
    cut "cut" false "a gap while the car moves, a jump of the speed or of the clock, or a long gap at rest is bridged at 1.0 and 1.5 m/s2";
}

impl Repairs {
    /// With the repair of this name, too; the same for a name that is none.
    #[must_use]
    pub(crate) fn with(mut self, word: &str) -> Repairs {
        self.set(word, true);
        self
    }

    /// Reads a list: `cut`, `no-smooth`, `none`, with commas between them.
    ///
    /// # Errors
    /// A word that is no repair.
    ///
    /// ```
    /// use cvtcycle_config::channel::Repairs;
    /// let repairs = Repairs::parse("cut,no-smooth")?;
    /// assert!(repairs.cut && !repairs.smooth && repairs.spikes);
    /// # Ok::<(), cvtcycle_config::Problem>(())
    /// ```
    pub fn parse(text: &str) -> Result<Repairs, Problem> {
        let mut repairs = Repairs::default();
        for word in text
            .split(',')
            .map(str::trim)
            .filter(|word| !word.is_empty())
        {
            let known = match word.strip_prefix("no-") {
                _ if word == "none" => {
                    repairs = Repairs::NONE;
                    true
                }
                _ if word == "auto" => true,
                Some(word) => repairs.set(word, false),
                None => repairs.set(word, true),
            };
            if !known {
                let names: Vec<&str> = Repairs::ALL.iter().map(|(name, _, _)| *name).collect();
                return Err(
                    Problem::unknown_name(format!("there is no repair `{word}`"))
                        .at(Argument::Repair)
                        .value(word)
                        .allowed(format!(
                            "{}; with no- before a name it is left out; none; auto",
                            names.join(", ")
                        )),
                );
            }
        }
        Ok(repairs)
    }
}

impl fmt::Display for Repairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list: Vec<&str> = Repairs::ALL
            .iter()
            .filter(|(_, is, _)| *is)
            .map(|(name, _, _)| *name)
            .collect();
        f.write_str(&list.join(","))
    }
}
