use cvtcycle::setup::*; use cvtcycle::simulate::*;
struct P; impl Recorder for P { fn record(&mut self, r:&cvtcycle::results::Row, t:&cvtcycle::results::Terms){ if r.time_s<4200.0 {println!("{} {:?} {:?}", r.time_s, r, t);} } }
fn main(){ let s=load("rover_216_cvt","",&Options::default()).map_err(|p|cvtcycle::config::render(&p,false)).unwrap(); let car=s.car(263.15);
println!("{:?}", car.engine.at(263.15,263.15,&car.engine_oil,1.0));
let c=cvtcycle::cycle::embedded("ece15_eudc").unwrap(); simulate(&car,c.trace_for(true),1.0,State::at(263.15),&mut P);}
