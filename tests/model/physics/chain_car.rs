//! A car with a chain. Truth: statics, second law, first law and ledgers by `check --physics`, whose code is apart from the model's; what a key may do.

use crate::common::{ZERO, at, car, cycle, fuel_kg, try_car};
use cvtcycle_model::drive::{Start, check_physics, drive};
use cvtcycle_model::rig::{Bench, BenchPoint};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

/// The Rover with a chain in place of its belt, whose keys are passed over.
const CHAIN: [&str; 6] = [
    "transmission.cvt.belt.kind.chain.pitch_mm=9",
    "transmission.cvt.belt.kind.chain.joint_lever_mm=0.02",
    "transmission.cvt.belt.kind.chain.pin_lever_mm=0.4",
    "transmission.cvt.belt.kind.chain.slip_percent=2",
    "transmission.cvt.belt.kind.chain.stiffness_n=5e6",
    "transmission.cvt.belt.mass_kg=1.68",
];

fn with(more: &[&str]) -> Vec<&'static str> {
    let own: Vec<&'static str> = CHAIN.to_vec();
    let more = more
        .iter()
        .map(|set| &*Box::leak((*set).to_owned().into_boxed_str()));
    own.into_iter().chain(more).collect()
}

#[test]
fn a_car_with_a_chain_obeys_the_laws() {
    for clamp in ["map", "torque_following"] {
        let set = format!("transmission.cvt.clamp={clamp}");
        let setup = car("rover_216_cvt", &with(&[&set]));
        for (name, ambient) in [("ece15_eudc", 25.0), ("ece15_eudc", -10.0), ("us06", 25.0)] {
            let found = check_physics(&setup, &cycle(name), ambient + ZERO, 1.0);
            for finding in found {
                assert!(
                    finding.rows > 0,
                    "{clamp} {name}: {:?} was not seen",
                    finding.law
                );
                assert!(finding.holds(), "{clamp} {name} {ambient}: {finding:?}");
            }
        }
    }
}

/// A chain at its torque: 1 to 6 % between the pulleys, by the sum of the table's terms (a unit that is lost would show here).
#[test]
fn a_chain_loses_a_few_percent() {
    let setup = car(
        "rover_216_cvt",
        &with(&["transmission.cvt.clamp=torque_following"]),
    );
    let bench = Bench::new(&setup);
    for ratio in [2.0, 1.0, 0.5] {
        let point = BenchPoint {
            ratio,
            input_rad_s: 200.0,
            output_nm: 40.0 * ratio * 4.0,
            belt_k: Some(80.0 + ZERO),
            ..BenchPoint::default()
        };
        let belt = bench.solve(&point).belt.unwrap();
        let lost = belt.losses.sum_nm() / belt.input_torque_nm;
        assert!(
            (0.01..0.06).contains(&lost),
            "{ratio}: {lost} {:?}",
            belt.losses
        );
        assert!(
            (0.002..0.025).contains(&belt.losses.slip_total),
            "{ratio}: {:?}",
            belt.losses
        );
    }
}

/// A chain has joints and pin ends and no bands; both losses are there, and none of the other.
#[test]
fn components_of_a_chain() {
    let setup = car("rover_216_cvt", &CHAIN);
    let own = setup.transmission().components();
    for (component, has) in [
        (Component::ChainJoint, true),
        (Component::ChainPin, true),
        (Component::BeltSlip, true),
        (Component::BeltBand, false),
        (Component::BeltFilm, false),
    ] {
        assert_eq!(own.contains(&component), has, "{component:?}");
    }
    let loss_j = drive(&setup, &cycle("ece15"), &at(25.0, Start::Warm))
        .totals
        .total()
        .loss_j;
    for component in [
        Component::ChainJoint,
        Component::ChainPin,
        Component::BeltSlip,
    ] {
        assert!(
            loss_j[component] > 100.0,
            "{component:?}: {} J",
            loss_j[component]
        );
    }
    let of_belts = [loss_j[Component::BeltBand], loss_j[Component::BeltFilm]];
    assert!(
        of_belts.iter().all(|loss| loss.abs() <= 0.0),
        "{of_belts:?}"
    );
    let belt = car("rover_216_cvt", &[]);
    let own = belt.transmission().components();
    assert!(own.contains(&Component::BeltBand) && !own.contains(&Component::ChainJoint));
}

/// Every number of a chain moves the fuel; a factor of 0 is a lever of 0; keys of bands are not read.
#[test]
fn no_number_of_a_chain_is_dead() {
    let c = cycle("ece15");
    let fuel = |sets: &[&str]| {
        fuel_kg(
            &car("rover_216_cvt", &with(sets)),
            &c,
            &at(25.0, Start::Warm),
        )
    };
    let own = fuel(&[]);
    for set in [
        "transmission.cvt.belt.kind.chain.pitch_mm=10",
        "transmission.cvt.belt.kind.chain.joint_lever_mm=0.05",
        "transmission.cvt.belt.kind.chain.pin_lever_mm=0.8",
        "transmission.cvt.belt.kind.chain.slip_percent=3",
        "transmission.cvt.belt.kind.chain.stiffness_n=2.5e6",
    ] {
        let moved = fuel(&[set]);
        assert!((moved / own - 1.0).abs() > 1e-6, "{set}: {own} {moved}");
    }
    let [factor, lever] = [
        "transmission.cvt.loss_factor.chain_joint=0",
        "transmission.cvt.belt.kind.chain.joint_lever_mm=0",
    ]
    .map(|set| fuel(&[set]));
    assert!(
        (factor / lever - 1.0).abs() < 1e-9 && factor < own,
        "{factor} {lever} {own}"
    );
    let setup = car("rover_216_cvt", &CHAIN);
    let bands = [
        "segment_thickness",
        "band_",
        "bands_",
        "shoulder",
        "youngs",
        "strut_area",
        "gap",
        "unity",
        "blend",
    ];
    for info in &setup.keys {
        let name = info
            .key
            .strip_prefix("transmission.cvt.belt.")
            .unwrap_or_default();
        assert!(
            !bands.iter().any(|begin| name.starts_with(begin)),
            "{}",
            info.key
        );
    }
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT")
    };
    // Units: the keys in mm, % and N, the model in SI.
    let chain = cvt.belt.chain.unwrap();
    let own = [
        chain.joint_m,
        chain.pin_m,
        chain.slip,
        chain.stiffness_n,
        cvt.belt.segment_thickness_m,
    ];
    for (own, wanted) in own.into_iter().zip([2e-5, 4e-4, 0.02, 5e6, 9e-3]) {
        assert!((own / wanted - 1.0).abs() < 1e-12, "{own} {wanted}");
    }
}

/// Keys of bands that are given with a chain, an unknown kind, a lever out of range, a chain that lacks a number: one problem each.
#[test]
fn mistakes_about_a_chain() {
    let refused = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        try_car("rover_216_cvt", &sets).unwrap_err()
    };
    let one = |text: &str, says: &[&str]| {
        assert_eq!(text.matches("error: ").count(), 1, "{text}");
        for part in says {
            assert!(text.contains(part), "{part}: {text}");
        }
    };
    let bands = refused(&with(&["transmission.cvt.belt.band_offset_mm=2"]));
    one(
        &bands,
        &[
            "band_offset_mm` is of a pushing belt",
            "remove it, or set transmission.cvt.belt.kind",
        ],
    );
    one(
        &refused(&["transmission.cvt.belt.kind=chains"]),
        &["chains", "push_belt, chain"],
    );
    let lever = refused(&with(&[
        "transmission.cvt.belt.kind.chain.joint_lever_mm=2",
    ]));
    one(&lever, &["joint_lever_mm", "0 to 1 mm"]);
    one(
        &refused(&CHAIN[1..]),
        &["missing", "transmission.cvt.belt.kind.chain.pitch_mm"],
    );
    let pitch = refused(&["transmission.cvt.belt.pitch_mm=9"]);
    one(&pitch, &["unknown key `transmission.cvt.belt.pitch_mm`"]);
}
