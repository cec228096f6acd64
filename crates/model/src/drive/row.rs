//! One row: everything that is known about one time step.

/// A loss component of the transmission, in the order of the power flow from the engine to the wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Component {
    /// Launch clutch slip and creep, W.
    LaunchClutch,
    /// Oil pump.
    Pump,
    /// Input shaft bearings and seals.
    InputShaft,
    /// Drag of the open reverse clutch.
    ClutchDrag,
    /// Boundary friction between bands and between band and segments.
    BeltBand,
    /// Viscous shear between the bands.
    BeltFilm,
    /// Sliding of the segments along the pulleys.
    BeltSlip,
    /// Wedging at pulley entry and exit.
    BeltWedge,
    /// Penetration into the deflected pulleys.
    BeltPenetration,
    /// Whole belt, from the user's measured map.
    BeltMap,
    /// Final drive of the CVT.
    FinalDrive,
    /// Gear mesh of the manual box, with its final drive.
    GearMesh,
    /// Bearings of the manual box.
    Bearing,
    /// Churning of the manual box.
    Churning,
    /// Seals of the manual box.
    Seal,
    /// Whole manual box, from the user's measured map.
    BoxMap,
}

impl Component {
    /// Number of components.
    pub const COUNT: usize = 16;
    /// All components, in the order of the power flow.
    pub const ALL: [Component; Self::COUNT] = [
        Component::LaunchClutch,
        Component::Pump,
        Component::InputShaft,
        Component::ClutchDrag,
        Component::BeltBand,
        Component::BeltFilm,
        Component::BeltSlip,
        Component::BeltWedge,
        Component::BeltPenetration,
        Component::BeltMap,
        Component::FinalDrive,
        Component::GearMesh,
        Component::Bearing,
        Component::Churning,
        Component::Seal,
        Component::BoxMap,
    ];

    /// Name as in JSON keys and CSV columns.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Component::LaunchClutch => "launch_clutch",
            Component::Pump => "pump",
            Component::InputShaft => "input_shaft",
            Component::ClutchDrag => "clutch_drag",
            Component::BeltBand => "belt_band",
            Component::BeltFilm => "belt_film",
            Component::BeltSlip => "belt_slip",
            Component::BeltWedge => "belt_wedge",
            Component::BeltPenetration => "belt_penetration",
            Component::BeltMap => "belt_map",
            Component::FinalDrive => "final_drive",
            Component::GearMesh => "gear_mesh",
            Component::Bearing => "bearing",
            Component::Churning => "churning",
            Component::Seal => "seal",
            Component::BoxMap => "box_map",
        }
    }
}

/// States and departures from validity of a row, as a bit set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(pub u32);

impl Flags {
    /// The car cannot follow the trace: engine at full load, torque missing.
    pub const MISSED_TRACE: Flags = Flags(1 << 0);
    /// Belt torque above what the clamping force carries.
    pub const GROSS_SLIP: Flags = Flags(1 << 1);
    /// Actual clamp safety factor below 1.
    pub const LOW_CLAMP: Flags = Flags(1 << 2);
    /// Pump flow does not cover the shift flow and leakage.
    pub const FLOW_LIMITED: Flags = Flags(1 << 3);
    /// An input left the validity range of a model or of a measured map.
    pub const OUTSIDE_VALIDITY: Flags = Flags(1 << 4);
    /// Ratio at one of its limits.
    pub const RATIO_LIMIT: Flags = Flags(1 << 5);
    /// Launch clutch slipping.
    pub const CLUTCH_SLIPPING: Flags = Flags(1 << 6);
    /// Launch clutch open.
    pub const CLUTCH_OPEN: Flags = Flags(1 << 7);
    /// The wheels drive the transmission.
    pub const OVERRUN: Flags = Flags(1 << 8);
    /// Fuel cut off in overrun.
    pub const FUEL_CUT: Flags = Flags(1 << 9);
    /// Engine switched off (soak).
    pub const ENGINE_OFF: Flags = Flags(1 << 10);
    /// The implicit solve stopped at its iteration bound above its tolerance.
    pub const NOT_CONVERGED: Flags = Flags(1 << 11);
    /// Pulling away in another ratio than low.
    pub const LAUNCH_NOT_IN_LOW: Flags = Flags(1 << 12);
    /// Engine speed above its limit.
    pub const OVERSPEED: Flags = Flags(1 << 13);

    /// Names in the order of the bits, as written in the trace.
    pub const NAMES: [(Flags, &'static str); 14] = [
        (Flags::MISSED_TRACE, "missed_trace"),
        (Flags::GROSS_SLIP, "gross_slip"),
        (Flags::LOW_CLAMP, "low_clamp"),
        (Flags::FLOW_LIMITED, "flow_limited"),
        (Flags::OUTSIDE_VALIDITY, "outside_validity"),
        (Flags::RATIO_LIMIT, "ratio_limit"),
        (Flags::CLUTCH_SLIPPING, "clutch_slipping"),
        (Flags::CLUTCH_OPEN, "clutch_open"),
        (Flags::OVERRUN, "overrun"),
        (Flags::FUEL_CUT, "fuel_cut"),
        (Flags::ENGINE_OFF, "engine_off"),
        (Flags::NOT_CONVERGED, "not_converged"),
        (Flags::LAUNCH_NOT_IN_LOW, "launch_not_in_low"),
        (Flags::OVERSPEED, "overspeed"),
    ];

    /// Whether every bit of `other` is set.
    #[must_use]
    pub fn contains(self, other: Flags) -> bool {
        self.0 & other.0 == other.0
    }

    /// Names of the flags that are set, in the order of the bits.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let set = Self::NAMES
            .iter()
            .filter(move |(flag, _)| self.contains(*flag));
        set.map(|(_, name)| *name)
    }

    /// Sets the bits of `flag` when `on`.
    pub fn set(&mut self, flag: Flags, on: bool) {
        self.0 |= if on { flag.0 } else { 0 };
    }
}

/// One time step: means over the step that ends at `time_s`; temperatures are those at its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// End of the step, s from the start of the cycle.
    pub time_s: f64,
    /// Length of the step, s.
    pub dt_s: f64,
    /// Index into the cycle's phases.
    pub phase: u16,
    /// Mean vehicle speed, m/s.
    pub speed_m_s: f64,
    /// Vehicle acceleration, m/s2.
    pub accel_m_s2: f64,
    /// Distance in the step, m.
    pub distance_m: f64,
    /// Demanded mean torque at the driven wheels, Nm.
    pub wheel_torque_nm: f64,
    /// Demanded mean power at the driven wheels, W.
    pub wheel_power_w: f64,
    /// Demanded work in the drive parts of the step, J, never negative.
    pub wheel_work_positive_j: f64,
    /// Demanded work in the braking parts of the step, J, never positive.
    pub wheel_work_negative_j: f64,
    /// Power that could not be delivered, W.
    pub deficit_w: f64,
    /// Engine speed, rad/s.
    pub engine_speed_rad_s: f64,
    /// Torque at the flywheel into the transmission, without rotating inertia, Nm.
    pub engine_torque_nm: f64,
    /// Engine torque with accessories, without inertia, over full-load torque at that speed, 0..1.
    pub throttle: f64,
    /// Gear of a manual box; 0 neutral or CVT.
    pub gear: u8,
    /// Belt ratio I = R_sec / R_pri (thesis eq. 5); NaN for a manual box.
    pub belt_ratio: f64,
    /// Engine speed over wheel speed; NaN at standstill.
    pub overall_ratio: f64,
    /// Primary pressure, Pa; NaN for a manual box.
    pub primary_pressure_pa: f64,
    /// Secondary pressure, Pa; NaN for a manual box.
    pub secondary_pressure_pa: f64,
    /// Belt slip as a fraction; NaN for a manual box.
    pub slip: f64,
    /// Torque capacity over torque of the belt; infinite at zero torque; NaN for a manual box.
    pub clamp_safety: f64,
    /// Loss power of each component, W, never negative.
    pub loss_w: [f64; Component::COUNT],
    /// Power of the accessories, W.
    pub accessories_w: f64,
    /// Power into the wheel brakes, W.
    pub brake_w: f64,
    /// Change of rotating kinetic energy of engine and transmission over the step length, W.
    pub kinetic_w: f64,
    /// Fuel mass flow, kg/s.
    pub fuel_kg_s: f64,
    /// Fuel power (lower heating value), W.
    pub fuel_power_w: f64,
    /// Heat into the engine's thermal nodes, W.
    pub engine_heat_w: f64,
    /// Heat and unburnt fuel into the exhaust, W.
    pub exhaust_w: f64,
    /// Coolant and block, K.
    pub coolant_k: f64,
    /// Engine oil, K.
    pub engine_oil_k: f64,
    /// Transmission oil in the sump, K.
    pub sump_k: f64,
    /// Transmission case and shafts, K.
    pub metal_k: f64,
    /// Belt, pulleys and the oil sprayed off them, K; NaN for a manual box.
    pub belt_spray_k: f64,
    /// Oil to the cooler, K; NaN without one.
    pub cooler_in_k: f64,
    /// Oil from the cooler, K; NaN without one.
    pub cooler_out_k: f64,
    /// Heat stored in the nodes, W.
    pub stored_w: f64,
    /// Heat given to the air, W.
    pub to_air_w: f64,
    /// Power ledger: |in - out| over the sum of absolute terms.
    pub power_ledger_error: f64,
    /// Heat ledger: |in - stored - to air| over the sum of absolute terms.
    pub heat_ledger_error: f64,
    /// What the implicit solve left, as a fraction of full-load torque.
    pub solve_residual: f64,
    /// Evaluations of the driveline that the implicit solve needed.
    pub iterations: u16,
    /// States and departures from validity.
    pub flags: Flags,
}
