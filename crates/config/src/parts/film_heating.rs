//! Reads the heating of a film by its own drag.

use crate::{Bound, Section};
use cvtcycle_model::transmission::film_heating::FilmHeating;

/// Reads `film_heating_w` of a part's table; none where it is absent.
pub fn load(s: &Section, doc: &str) -> FilmHeating {
    FilmHeating::halving_at_w(s.optional_number("film_heating_w", Bound::closed(1.0, 1e9), doc))
}
