#[path = "suite/samples.rs"] mod samples;
use samples::*;
use voronudge_model::gradient_check::*;
use voronudge_geometry::*;
use std::collections::BTreeMap;
#[test] fn probe() {
    let mut sets: Vec<(&str, Tissue)> = vec![];
    for s in 0..10 { sets.push(("random box", (random(150,[12.0,12.5],s), periodic([12.0,12.5]).unwrap())));
      sets.push(("sheared", (random(150,[12.0,12.5],s), sheared([12.0,12.5],2.2).unwrap())));
      sets.push(("open", (random(150,[12.0,12.5],s), Domain::Open)));
      sets.push(("open900", (random(900,[30.0,30.0],s), Domain::Open)));
      sets.push(("box900", (random(900,[30.0,30.0],s), periodic([30.0,30.0]).unwrap())));
      for c in 1..=6usize { sets.push(("tiny", (random(c,[(c as f64).sqrt();2],s+7), periodic([(c as f64).sqrt();2]).unwrap()))); }
      sets.push(("jitter 1e-3", (jittered(8,8,1e-3,s), periodic([8.0,8.0]).unwrap())));
      sets.push(("jitter 1e-6", (jittered(8,8,1e-6,s), periodic([8.0,8.0]).unwrap())));
      sets.push(("open jitter 1e-6", (jittered(8,8,1e-6,s), Domain::Open)));
      sets.push(("open jitter 1e-12", (jittered(8,8,1e-12,s), Domain::Open)));
      for d in [1e-2,1e-4,1e-6,1e-8] { let mut p = jittered(8,8,0.3,s); p[12]=p[40]+Vector::new(0.6,0.8)*d; sets.push(("pair", (p, periodic([8.0,8.0]).unwrap())));
       let mut p = jittered(8,8,0.3,s); p[27]=p[28]+Vector::new(0.6,0.8)*d; sets.push(("pair open", (p, Domain::Open))); }
    }
    sets.push(("void", (random(3000,[4.0,4.0],1), periodic([50.0,50.0]).unwrap())));
    sets.push(("20000", (random(20000,[200.0,100.0],1), periodic([200.0,100.0]).unwrap())));
    sets.push(("600", (random(600,[20.0,30.0],1), periodic([20.0,30.0]).unwrap())));
    let hc = honeycomb(8,8); sets.push(("honeycomb", (hc.0, periodic(hc.1).unwrap())));
    sets.push(("square", (jittered(8,8,0.0,0), periodic([8.0,8.0]).unwrap())));
    let mut worst: BTreeMap<String,(f64,String)> = BTreeMap::new();
    for (name,(p,d)) in sets {
        let t = std::time::Instant::now();
        let r = check(&p,d,&parameters()).unwrap();
        if p.len()>=600 { println!("{name} {} cells {:?}", p.len(), t.elapsed()); }
        for row in &r.rows {
            if !row.passed() { println!("FAIL {name} {}: {} {} {:.1e} at {}", p.len(), row.term,row.quantity,row.worst,row.place); }
            let e = worst.entry(row.quantity.to_string()).or_insert((0.0,String::new()));
            if row.worst > e.0 { *e=(row.worst, format!("{name} {} {} {}", p.len(), row.term, row.compared)); }
        }
    }
    for (k,v) in worst { println!("{k:45} {:.1e} {}", v.0, v.1); }
    let p = random(150,[12.0,12.5],3);
    for row in check(&p, periodic([12.0,12.5]).unwrap(), &parameters()).unwrap().rows { println!("{:22} {:40} {:.1e} {}", row.term, row.quantity, row.worst, row.compared); }
}
