//! A hydrodynamic torque converter with a lock-up clutch.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TC-1 | T_e = lambda(nu) w_e2, T_t = k(nu) T_e at nu = w_t/w_e from 0 to 1, lambda and k linear between the rows of a table, lambda(1) = 0 | source: form of ISO/DIN capacity tables; table of a 4L60E (ADVISOR, TX_AUTO4_4L60E), lambda made to fall, sized by the key; warm fluid |
//! | TC-2 | driving: y = T_t/w_t2 = k lambda/nu2 falls strictly with nu; in a piece k = a + b nu, lambda = c + d nu: a c w_e2 + (a d + b c) w_t w_e + b d w_t2 = T_t, the larger root; w_e >= idle | derived: TC-1 solved for the engine |
//! | TC-3 | creep: T_t = k(nu) lambda(nu) w_idle2 at nu = w_t/w_idle, none from nu = 1; at rest times the share that neutral idle leaves | derived: TC-1 at idle |
//! | TC-4 | loss = T_e w_e - T_t w_t, never negative for k nu <= 1; all of it heats the sump | derived: power balance |
//! | TC-5 | T_e = T_t/k(nu) at the speeds in force; TC-1 holds for the engine's speed as far as its inertia lets it get there | ASSUMED, as LC-1 |
//! | TC-6 | overrun, open: \|T\| = c lambda(r) w_t2 at r = w_e/w_t, k = 1; at least T_t = -min(absorbed, c lambda(w_idle/w_t) w_t2) | ASSUMED: the table mirrored; c 0.7 to 1.5 (1.4 is printed at nu 1.09) |
//! | TC-7 | lock-up: closes above v_on and T_on and 1.1 n_least, n_least the larger of n_open and idle; opens below v_off, T_on - 3 K or n_least; once a step, from the state before it | temperature source: Honda Civic and Volvo XC70 service data, 20 degC; speeds and widths ASSUMED |
//! | TC-8 | slip lock-up: w_e - w_t = dn clip(T_t/10 Nm, 0, 1), up to a temperature of the sump; T_e = T_t | source: Volvo XC70 2009: 50 rpm at 20 to 120 degC; ramp ASSUMED |
//! | TC-9 | a lock-up that closes: w_e - w_t falls as exp(-t/tau) from what it is when it begins, its mean over the step with its end kept; loss T_t times it | ASSUMED: tau 0.15 s (0.1 to 0.3), closed to 5 % after half a second; the torque of the slower engine goes to the wheels, whatever the step |
//!
//! w_e, w_t are the speeds of pump wheel (engine) and turbine (box). Laminar effects of fluid below 40 degC are left out. An engine that is
//! slower than the turbine it drives, or faster than the one that drives it, can only be so by inertia: power passes unchanged, as in CV-6.

use super::{Coupling, CouplingLoad, EngineSide, Hold, LockSignals, Turning, together};
use crate::keys::{Bound, Quantity, Values, keys};
use crate::math::{
    Curve, Gather, MAX_LANES, Mask, Real, both, gather_each, larger, physics, places,
};
use std::sync::Arc;

/// Torque ratio and capacity of the original at a speed ratio: [nu, k, lambda/lambda(0)].
const TABLE: [[f64; 3]; 29] = table();

/// Speed of the pump wheel for 100 Nm, rpm, and torque ratio at the speed ratios 0 to 0.1 by 0.01, then by 0.05 (ADVISOR).
const ORIGINAL: [(f64, f64); 29] = [
    (1444.0, 2.0),
    (1444.0, 1.99), // printed 1443: lambda is made to fall
    (1446.0, 1.98),
    (1448.0, 1.96),
    (1450.0, 1.95),
    (1453.0, 1.94),
    (1456.0, 1.93),
    (1459.0, 1.92),
    (1461.0, 1.91),
    (1464.0, 1.89),
    (1466.0, 1.88),
    (1480.0, 1.83),
    (1494.0, 1.77),
    (1509.0, 1.72),
    (1525.0, 1.66),
    (1549.0, 1.60),
    (1574.0, 1.55),
    (1604.0, 1.49),
    (1637.0, 1.43),
    (1678.0, 1.38),
    (1722.0, 1.32),
    (1775.0, 1.26),
    (1833.0, 1.21),
    (1899.0, 1.15),
    (1973.0, 1.10),
    (2107.0, 1.04),
    (2272.0, 1.0),
    (3044.0, 1.0),
    (f64::INFINITY, 1.0), // printed 3045: torque passes through zero at equal speeds
];

/// Time constant with which a lock-up clutch closes, s (TC-9).
const CLOSING_S: f64 = 0.15;
/// Slip up to which it has closed, rad/s.
const CLOSED_RAD_S: f64 = 0.01;

const fn table() -> [[f64; 3]; 29] {
    let mut rows = [[0.0; 3]; 29];
    let mut i = 0;
    while i < 29 {
        let (rpm, k) = ORIGINAL[i];
        let share = ORIGINAL[0].0 / rpm;
        let nu = if i <= 10 {
            i as f64 / 100.0
        } else {
            (i as f64 - 8.0) / 20.0
        };
        rows[i] = [nu, k, share * share];
        i += 1;
    }
    rows
}

/// One row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    /// Speed ratio.
    nu: f64,
    /// Capacity, Nm s2.
    lambda: f64,
    /// 2 a c, a d + b c and b d of the piece that begins here, Nm s2 (TC-2).
    quadratic: [f64; 3],
    /// k lambda/nu2, Nm s2 (TC-2).
    pull: f64,
    /// Capacity in overrun, which never rises, Nm s2 (TC-6).
    coast: f64,
}

#[physics]
impl Row {
    /// True at or before a speed ratio; needs no second number.
    fn is_up_to(&self, nu: f64, _: f64) -> bool {
        self.nu <= nu
    }

    /// True if the turbine gets more than a torque, Nm, at a square of its speed, (rad/s)2.
    fn pulls_above(&self, turbine_nm: f64, square: f64) -> bool {
        self.pull * square > turbine_nm
    }

    /// True if the engine takes more than a torque in overrun, Nm.
    fn coasts_above(&self, drag_nm: f64, square: f64) -> bool {
        self.coast * square > drag_nm
    }
}

/// The rows of a converter, at least four; copies share them.
#[derive(Clone, Debug, PartialEq)]
struct Rows(Arc<[Row]>);

gather_each!(Rows);

/// When the lock-up clutch closes, and how.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct LockUp<R: Real = f64> {
    /// Road speed above which it closes, m/s.
    pub from_m_s: R,
    /// Road speed below which it opens, m/s.
    pub until_m_s: R,
    /// Temperature of the sump above which it closes, K.
    pub from_k: R,
    /// Speed of the turbine below which it opens, rad/s.
    pub open_rad_s: R,
    /// Slip of a lock-up clutch that does not close in full, rad/s.
    pub slip_rad_s: R,
    /// Temperature of the sump up to which it slips, K.
    pub slip_until_k: R,
}

/// The checked torque converter.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct TorqueConverter<R: Real = f64> {
    rows: R::PerLane<Rows>,
    /// Torque ratio over speed ratio.
    k: R::Curve,
    neutral_idle: R,
    lockup: Option<LockUp<R>>,
}

/// Speed of the turbine from which the lock-up clutch closes, over that below which it opens (TC-7).
const CLOSES_OVER_OPEN: f64 = 1.1;
/// Fall of the sump's temperature with which it opens again, K (TC-7).
const COOLER_K: f64 = 3.0;
/// Torque from which it slips in full, Nm (TC-8).
const SLIP_FROM_NM: f64 = 10.0;

impl TorqueConverter {
    /// A converter of a capacity at stall, Nm s2, by a table [nu, k, lambda/lambda(0)] from 0 to 1 whose nu rises, with a factor on its capacity in overrun.
    pub fn new(
        capacity_nm_s2: f64,
        table: &[[f64; 3]],
        coast_factor: f64,
        neutral_idle: f64,
        lockup: Option<LockUp>,
    ) -> Self {
        let mut rows: Vec<Row> = table
            .iter()
            .map(|[nu, k, share]| {
                let lambda = share * capacity_nm_s2;
                Row {
                    nu: *nu,
                    lambda,
                    quadratic: [0.0; 3],
                    pull: k * lambda / (nu * nu),
                    coast: coast_factor * lambda,
                }
            })
            .collect();
        for i in (1..rows.len()).rev() {
            rows[i - 1].coast = larger(rows[i].coast, rows[i - 1].coast);
            let per_nu = 1.0 / (rows[i].nu - rows[i - 1].nu);
            let b = (table[i][1] - table[i - 1][1]) * per_nu;
            let d = (rows[i].lambda - rows[i - 1].lambda) * per_nu;
            let a = table[i - 1][1] - b * rows[i - 1].nu;
            let c = rows[i - 1].lambda - d * rows[i - 1].nu;
            rows[i - 1].quadratic = [2.0 * a * c, a * d + b * c, b * d]; // TC-2
        }
        let k: Vec<(f64, f64)> = table.iter().map(|[nu, k, _]| (*nu, *k)).collect();
        TorqueConverter {
            rows: Rows(rows.into()),
            k: Curve::new(&k).unwrap_or_else(|_| Curve::constant(1.0)),
            neutral_idle,
            lockup,
        }
    }
}

/// A piece of the table, for each run: the rows at its ends.
struct Piece<'a, R: Real> {
    rows: &'a R::PerLane<Rows>,
    first: [usize; MAX_LANES],
    like: R,
}

#[physics]
impl<R: Real> Piece<'_, R> {
    /// A number of the rows at both ends.
    fn ends(&self, of: fn(&Row) -> f64) -> [R; 2] {
        both!(end => self.like.map_lanes(
            |lane| of(&R::get(self.rows, lane).0[self.first[lane] + end]),
        ))
    }

    /// The numbers of the piece's quadratic equation.
    fn quadratic(&self) -> [R; 3] {
        places!(place in 0, 1, 2 => self.like.map_lanes(
            |lane| R::get(self.rows, lane).0[self.first[lane]].quadratic[place],
        ))
    }

    fn nu(&self) -> [R; 2] {
        self.ends(|row| row.nu)
    }

    fn lambda(&self) -> [R; 2] {
        self.ends(|row| row.lambda)
    }

    fn coast(&self) -> [R; 2] {
        self.ends(|row| row.coast)
    }
}

#[physics]
impl<R: Real> TorqueConverter<R> {
    /// The piece that begins with the last row for which `before` holds with the numbers of a lane, the first one at least.
    fn piece(&self, x: R, y: R, before: fn(&Row, f64, f64) -> bool) -> Piece<'_, R> {
        let mut first = [0; MAX_LANES];
        for (lane, first) in first.iter_mut().enumerate().take(R::LANES) {
            let rows = &R::get(&self.rows, lane).0;
            // Plain numbers: the search is a function of its own, which does not have the processor's vectors.
            let (x, y) = (x.lane(lane), y.lane(lane));
            *first = rows[1..rows.len() - 1].partition_point(|row| before(row, x, y));
        }
        Piece {
            rows: &self.rows,
            first,
            like: x,
        }
    }

    /// Capacity at a speed ratio from 0 to 1, Nm s2.
    fn lambda_nm_s2(&self, nu: R) -> R {
        let p = self.piece(nu, nu, Row::is_up_to);
        let (at, lambda) = (p.nu(), p.lambda());
        let share = (nu - at[0]) / (at[1] - at[0]);
        lambda[0] + share * (lambda[1] - lambda[0]) // TC-1
    }

    /// Speed of the engine that drives a turbine with a torque, rad/s (TC-2).
    fn driving_rad_s(&self, turbine_nm: R, turbine_rad_s: R) -> R {
        let square = turbine_rad_s * turbine_rad_s;
        let p = self.piece(turbine_nm, square, Row::pulls_above);
        let [double_ac, ad_bc, bd] = p.quadratic();
        let linear = -ad_bc * turbine_rad_s;
        let rest = linear * linear + 2.0 * double_ac * (turbine_nm - bd * square);
        (linear + rest.max(0.0).sqrt()) / double_ac // TC-2
    }

    /// Speed of an engine that takes a torque from the turbine, rad/s (TC-6).
    fn coasting_rad_s(&self, drag_nm: R, turbine_rad_s: R) -> R {
        let square = turbine_rad_s * turbine_rad_s;
        let p = self.piece(drag_nm, square, Row::coasts_above);
        let (nu, coast) = (p.nu(), p.coast());
        let share = (coast[0] * square - drag_nm) / ((coast[0] - coast[1]) * square);
        let speed = (nu[0] + share * (nu[1] - nu[0])) * turbine_rad_s; // TC-6
        // No engine at rest takes more.
        let most = square.map_lanes(|lane| R::get(&self.rows, lane).0[0].coast);
        (most * square).le(drag_nm).select(speed.splat(0.0), speed)
    }

    /// Largest torque that an idling engine's pump wheel takes from the turbine, Nm (TC-6).
    fn coast_at_idle_nm(&self, turbine_rad_s: R, idle_rad_s: R) -> R {
        let r = idle_rad_s / turbine_rad_s;
        let p = self.piece(r, r, Row::is_up_to);
        let (nu, coast) = (p.nu(), p.coast());
        let share = (r - nu[0]) / (nu[1] - nu[0]);
        (coast[0] + share * (coast[1] - coast[0])) * turbine_rad_s * turbine_rad_s
    }

    /// The engine's side at known speeds.
    fn side(&self, output_nm: R, output_rad_s: R, engine_rad_s: R) -> EngineSide<R> {
        let drives = output_nm.ge(0.0) & engine_rad_s.ge(output_rad_s);
        let coasts = output_nm.lt(0.0) & engine_rad_s.le(output_rad_s);
        let mut engine_nm = output_nm; // TC-6
        if drives.any() {
            let driving_nm = output_nm / (output_rad_s / engine_rad_s).interpolate(&self.k); // TC-5
            engine_nm = drives.select(driving_nm, engine_nm);
        }
        let mut loss_w = (engine_nm * engine_rad_s - output_nm * output_rad_s).max(0.0); // TC-4
        let passes = !(drives | coasts);
        if passes.any() {
            let passed_nm = output_nm * output_rad_s / engine_rad_s;
            engine_nm = passes.select(passed_nm, engine_nm);
            loss_w = passes.select(loss_w.splat(0.0), loss_w);
        }
        EngineSide {
            engine_nm,
            engine_rad_s,
            loss_w,
        }
    }

    /// Torque into the box that the idling engine passes on, Nm.
    fn creeping_nm(&self, output_rad_s: R, idle_rad_s: R) -> R {
        let nu = output_rad_s / idle_rad_s;
        let (k, lambda) = (nu.interpolate(&self.k), self.lambda_nm_s2(nu));
        let turns = output_rad_s.gt(0.0);
        let share = turns.select(nu.splat(1.0), self.neutral_idle);
        let creep_nm = share * k * lambda * idle_rad_s * idle_rad_s; // TC-3
        nu.ge(1.0).select(nu.splat(0.0), creep_nm)
    }
}

/// The parts with a look-up in the table are functions of their own, so that cars with a clutch do not carry them.
#[physics]
impl<R: Real> Coupling<R> for TorqueConverter<R> {
    #[inline(never)]
    fn engine_rad_s(&self, load: &CouplingLoad<R>) -> R {
        load.output_nm.vectorize(|| {
            let (nm, rad_s) = (load.output_nm, load.output_rad_s);
            let drives = nm.gt(0.0);
            let mut wanted = nm;
            if drives.any() {
                wanted = self.driving_rad_s(nm, rad_s);
            }
            if !drives.all() {
                wanted = drives.select(wanted, self.coasting_rad_s(-nm, rad_s));
            }
            wanted.max(load.idle_rad_s)
        })
    }

    #[inline]
    fn device(&self) -> &'static str {
        super::CONVERTER.name
    }

    /// The engine may be slower than the turbine that drives it.
    fn min_engine_rad_s(&self, output_rad_s: R) -> R {
        output_rad_s.splat(0.0)
    }

    fn locked_from_rad_s(&self, idle_rad_s: R) -> R {
        match &self.lockup {
            Some(lockup) => lockup.open_rad_s.max(idle_rad_s),
            None => idle_rad_s.splat(f64::INFINITY),
        }
    }

    fn by_command(&self) -> bool {
        true
    }

    fn hold(&self, now: &LockSignals<R>, past: R::Mask) -> Hold<R> {
        let zero = now.sump_k.splat(0.0);
        let Some(lockup) = &self.lockup else {
            return Hold {
                coupled: zero.splat_mask(false),
                locked_from_rad_s: zero.splat(f64::INFINITY),
                slip_rad_s: zero,
                closing_rad_s: zero,
                left_share: zero.splat(1.0),
            };
        };
        let least_rad_s = self.locked_from_rad_s(now.idle_rad_s);
        let speed_m_s = past.select(lockup.until_m_s, lockup.from_m_s);
        let sump_k = past.select(lockup.from_k - COOLER_K, lockup.from_k);
        let turbine_rad_s = past.select(least_rad_s, CLOSES_OVER_OPEN * least_rad_s);
        let closes = speed_m_s.lt(now.speed_m_s)
            & now.sump_k.gt(sump_k)
            & now.output_rad_s.gt(turbine_rad_s); // TC-7
        let slips = closes & now.sump_k.le(lockup.slip_until_k);
        let steady_rad_s = slips.select(lockup.slip_rad_s, zero);
        let faster_rad_s = closes.select(now.faster_rad_s, zero);
        let (mut mean_rad_s, mut closing_rad_s) = (zero, zero);
        if faster_rad_s.gt(CLOSED_RAD_S).any() {
            let left = (-now.dt_s / zero.splat(CLOSING_S)).exp();
            closing_rad_s = faster_rad_s * left; // TC-9
            mean_rad_s = faster_rad_s * (1.0 - left) * (CLOSING_S / zero.splat(now.dt_s));
            let open = faster_rad_s.gt(CLOSED_RAD_S);
            closing_rad_s = open.select(closing_rad_s, zero);
            mean_rad_s = open.select(mean_rad_s, zero);
        }
        Hold {
            coupled: closes,
            locked_from_rad_s: closes.select(zero, zero.splat(f64::INFINITY)),
            slip_rad_s: steady_rad_s + mean_rad_s,
            closing_rad_s,
            left_share: mean_rad_s.gt(0.0).select(
                (steady_rad_s + closing_rad_s) / (steady_rad_s + mean_rad_s),
                zero.splat(1.0),
            ),
        }
    }

    fn locked_side(&self, output_nm: R, output_rad_s: R, slip_rad_s: R) -> EngineSide<R> {
        let slip_rad_s = slip_rad_s * (output_nm / SLIP_FROM_NM).clamp(0.0, 1.0); // TC-8
        EngineSide {
            engine_nm: output_nm,
            engine_rad_s: output_rad_s + slip_rad_s,
            loss_w: output_nm * slip_rad_s,
        }
    }

    #[inline(never)]
    fn engine_side(&self, output_nm: R, output_rad_s: R, engine_rad_s: R) -> EngineSide<R> {
        output_nm.vectorize(|| self.side(output_nm, output_rad_s, engine_rad_s))
    }

    #[inline(never)]
    fn output_nm(&self, engine_nm: R, output_rad_s: R, engine_rad_s: R) -> R {
        engine_nm.vectorize(|| {
            let drags = engine_nm.lt(0.0);
            let drives = !drags & engine_rad_s.ge(output_rad_s);
            let mut output_nm = engine_nm;
            if drives.any() {
                let driving_nm = engine_nm * (output_rad_s / engine_rad_s).interpolate(&self.k); // TC-1
                output_nm = drives.select(driving_nm, output_nm);
            }
            let passes = !(drags | drives);
            if passes.any() {
                let passed_nm = engine_nm * engine_rad_s / output_rad_s;
                output_nm = passes.select(passed_nm, output_nm);
            }
            output_nm
        })
    }

    #[inline(never)]
    fn creep_nm(&self, output_rad_s: R, idle_rad_s: R) -> R {
        idle_rad_s.vectorize(|| self.creeping_nm(output_rad_s, idle_rad_s))
    }

    fn overrun_share(&self, output_rad_s: R, idle_rad_s: R) -> R {
        let one = idle_rad_s.splat(1.0);
        output_rad_s.gt(idle_rad_s).select(one, one.splat(0.0))
    }

    #[inline(never)]
    fn min_output_nm(&self, at: &Turning<R>, absorbed_nm: R) -> R {
        absorbed_nm.vectorize(|| {
            let mut least_nm = -absorbed_nm;
            let creeps = !at.locked & at.output_rad_s.lt(at.idle_rad_s);
            if creeps.any() {
                let creep_nm = self.creeping_nm(at.output_rad_s, at.idle_rad_s);
                least_nm = creeps.select(creep_nm, least_nm);
            }
            let coasts = !(at.locked | creeps);
            if coasts.any() {
                let carried_nm = self.coast_at_idle_nm(at.output_rad_s, at.idle_rad_s);
                let coast_nm = -together(at) * absorbed_nm.min(carried_nm); // TC-6
                least_nm = coasts.select(coast_nm, least_nm);
            }
            least_nm
        })
    }
}

keys! {
    /// Keys of `[transmission.cvt.launch.torque_converter]`.
    TORQUE_CONVERTER: TorqueConverterKeys = "torque_converter" [LockUpKeys::TABLE] {
        capacity_nm: number(5.0, 300.0), "engine torque at stall and 1000 rpm", ["TC-1"];
        table: optional(rows(&[("speed_ratio", Bound::closed(0.0, 1.0)), ("torque_ratio", Bound::closed(0.8, 4.0)), ("capacity_share", Bound::closed(0.0, 3.0))])), "rows [speed ratio, torque ratio, capacity over that at stall] from 0 to 1; absent: those of a 4L60E", ["TC-1"];
        coast_factor: or(1.0, number(0.3, 3.0)), "capacity in overrun over that of the mirrored table", ["TC-6"];
        neutral_idle: or(1.0, number(0.0, 1.0)), "share of creep that is left at rest; 1 without neutral idle", ["TC-3"];
    }

    /// Keys of `[transmission.cvt.launch.torque_converter.lockup]`.
    LOCK_UP: LockUpKeys = "lockup" [] {
        enabled: flag(true), "whether the lock-up clutch ever closes", ["TC-7"];
        from_kmh: or(15.0, number(0.0, 200.0)), "road speed above which the lock-up clutch closes", ["TC-7"];
        until_kmh: or(10.0, number(0.0, 200.0)), "road speed below which the lock-up clutch opens", ["TC-7"];
        from_degc: or(20.0, number(-60.0, 120.0)), "temperature of the sump above which the lock-up clutch closes", ["TC-7"];
        open_rpm: or(900.0, number(0.0, 3000.0)), "turbine speed below which the lock-up clutch opens, idle speed at least", ["TC-7"];
        slip_rpm: or(0.0, number(0.0, 300.0)), "slip that a lock-up clutch keeps when closed", ["TC-8"];
        slip_until_degc: or(120.0, number(-60.0, 150.0)), "temperature of the sump up to which the lock-up clutch slips", ["TC-8"];
    }
}

impl TorqueConverter {
    /// A converter from the values of its keys.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        // Given at 1000 rpm.
        let thousand_rpm = Quantity::from_key("_rpm").to_si(1000.0);
        let per_square = thousand_rpm * thousand_rpm;
        let capacity_nm_s2 = s.number(&TORQUE_CONVERTER.capacity_nm) / per_square;
        let own = s.rows(&TORQUE_CONVERTER.table).unwrap_or_default();
        let own: Vec<[f64; 3]> = own.iter().map(|row| [row[0], row[1], row[2]]).collect();
        let fits = own.is_empty() || check_table(s, &own);
        let table = if own.is_empty() || !fits {
            &TABLE[..]
        } else {
            &own
        };
        TorqueConverter::new(
            capacity_nm_s2,
            table,
            s.number(&TORQUE_CONVERTER.coast_factor),
            s.number(&TORQUE_CONVERTER.neutral_idle),
            LockUp::from_values(&s.table("lockup")),
        )
    }
}

/// True for a table that TC-2 and TC-4 allow; else the first problem is reported.
fn check_table<V: Values>(s: &V, table: &[[f64; 3]]) -> bool {
    let (first, last) = (table[0], table[table.len() - 1]);
    let pull = |[nu, k, share]: &[f64; 3]| k * share / (nu * nu);
    let is = |x: f64, y: f64| (x - y).abs() <= 1e-9;
    let [problem, hint] = if table.len() < 4 {
        [
            "the table has less than 4 rows",
            "give rows from stall to equal speeds",
        ]
    } else if !is(first[0], 0.0) || !is(first[2], 1.0) {
        [
            "the first row is not that of the stall",
            "begin with [0, torque ratio at stall, 1]; `capacity_nm` is the capacity there",
        ]
    } else if !is(last[0], 1.0) || !is(last[1], 1.0) || !is(last[2], 0.0) {
        [
            "the last row is not that of equal speeds",
            "end with [1, 1, 0]: at equal speeds no torque passes",
        ]
    } else if table.windows(2).any(|w| w[0][0] >= w[1][0]) {
        [
            "the speed ratio does not rise from row to row",
            "sort the rows and remove doubled ones",
        ]
    } else if table.iter().any(|[nu, k, _]| k * nu > 1.0 + 1e-9) {
        [
            "speed ratio times torque ratio, the efficiency, is above 1",
            "check the torque ratios next to equal speeds",
        ]
    } else if table[1..].windows(2).any(|w| pull(&w[0]) <= pull(&w[1])) {
        [
            "torque ratio times capacity over the square of the speed ratio does not fall",
            "an engine could turn at two speeds for one torque: check the capacities",
        ]
    } else {
        return true;
    };
    let allowed = "rows [speed ratio, torque ratio, capacity share] from [0, k, 1] to [1, 1, 0]";
    s.complain(TORQUE_CONVERTER.table.name, allowed, problem, hint);
    false
}

impl LockUp {
    /// The lock-up clutch, if it ever closes.
    fn from_values<V: Values>(s: &V) -> Option<Self> {
        let enabled = s.flag(&LOCK_UP.enabled);
        let lockup = LockUp {
            from_m_s: s.number(&LOCK_UP.from_kmh),
            until_m_s: s.number(&LOCK_UP.until_kmh),
            from_k: s.number(&LOCK_UP.from_degc),
            open_rad_s: s.number(&LOCK_UP.open_rpm),
            slip_rad_s: s.number(&LOCK_UP.slip_rpm),
            slip_until_k: s.number(&LOCK_UP.slip_until_degc),
        };
        if lockup.until_m_s > lockup.from_m_s {
            s.complain(
                LOCK_UP.until_kmh.name,
                "at most from_kmh",
                "the lock-up clutch would open at the speed at which it closes",
                "lower it or raise `from_kmh`",
            );
        }
        enabled.then_some(lockup)
    }
}
