mod common;
use common::*;
use stickslip::model::contact::Problem;
use stickslip::model::Operation;
use stickslip::scenario::Formulation::Series;
use stickslip::effects;
use stickslip::solver::time;
#[test]
fn dbg() {
    let table = include_str!("data/effects.csv");
    let mut worst = std::collections::BTreeMap::new();
    for line in table.lines().skip(1) {
        let c: Vec<&str> = line.split(',').collect();
        let v: Vec<f64> = c[2..].iter().map(|v| v.parse().unwrap()).collect();
        let at = Operation { speed: v[0], load: v[1], drive: v[2], frequency: v[3] };
        let mut model = paper_model(Series);
        if c[0] != "none" {
            let e = effects::find(c[0]).unwrap();
            let p: Vec<f64> = e.parameters().iter().map(|q| c[1].split(' ').find_map(|w| w.strip_prefix(&format!("{}=", q.key))).unwrap().parse().unwrap()).collect();
            model.effects.push((e, p));
        }
        let problem = Problem::new(&model, &at);
        let t0 = std::time::Instant::now();
        let o = time::integrate(&problem.sliders(), &time::Plan::default());
        let el = t0.elapsed();
        let (re, im) = problem.lumps.free_response();
        let (re, im) = (re.value + o.fundamental.0, im.value + o.fundamental.1);
        let t1 = std::time::Instant::now();
        let s = steady(&model, &at);
        let el1 = t1.elapsed();
        let z = complex(&s);
        let ph = stickslip::solver::analytic::wrap(im.atan2(re) + problem.lumps.phase_offset.value);
        let al = re.hypot(im);
        let d = (al / s.amplitude - 1.0).abs().max((ph - s.phase).abs());
        let _ = z;
        let e = worst.entry(c[0].to_string()).or_insert((0.0f64, 0.0f64, 0.0f64, String::new()));
        let r = (s.amplitude / v[4] - 1.0).abs().max((s.phase - v[5]).abs());
        if r > 8e-5 { println!("REF {line} {r:.2e} {:?}", s.status); }
        e.2 = e.2.max(el1.as_secs_f64() * 1e6);
        e.1 = e.1.max(r);
        if d > e.0 || d.is_nan() { e.0 = d; e.3 = format!("{line} periodic {} cycles {} {:?}", o.periodic, o.cycles, el); }
    }
    for (k, v) in worst { println!("EFF {k} shooting-time {:.2e} ref {:.2e} us {:.0} at {}", v.0, v.1, v.2, v.3); }
}
