//! trial
use midair::*;
use std::time::Instant;
fn main() {
    for (n, side, ms) in
        [(400usize, 20usize, &[4usize, 16, 64, 256][..]), (996, 0, &[4, 16, 64, 256]), (1296, 36, &[38])]
    {
        for &m in ms {
            let array = if side == 0 {
                Array::preset("autd3", [2, 2]).unwrap()
            } else {
                Array::grid(side, side, 10e-3).unwrap()
            };
            assert_eq!(array.len(), n);
            let mut rng = Rng::new(m as u64);
            let points: Vec<[f64; 3]> = (0..m)
                .map(|_| {
                    let mut c = || (2.0 * rng.uniform() - 1.0) * 0.1;
                    [c(), c(), 0.15]
                })
                .collect();
            let medium = Medium::default();
            let p1 = 4.386 * n as f64 / 0.2;
            let request = Request { pressures: Some(vec![p1 / (m as f64).sqrt() * 0.9; m]), weights: None };
            let scene = Scene::new(array, medium, points, request).unwrap();
            let args: Vec<String> = std::env::args().collect();
            let names = args
                .get(1)
                .filter(|a| !a.starts_with("--"))
                .map(|a| a.split(',').map(String::from).collect::<Vec<_>>())
                .unwrap_or(vec!["greedy".into(), "fast".into()]);
            for level in Level::all() {
                let problem =
                    Problem::with_gains(Gains::of(&scene).with_level(level), scene.request()).unwrap();
                let t = Instant::now();
                for _ in 0..20 {
                    std::hint::black_box(Problem::new(&scene).unwrap());
                }
                let prep = t.elapsed().as_secs_f64() / 20.0;
                for name in &names {
                    for options in
                        if name == "greedy" { vec![(16i128, 1i128), (256, 16)] } else { vec![(0, 0)] }
                    {
                        let list: Options = if options.0 > 0 {
                            [
                                ("phases".into(), Value::Integer(options.0)),
                                ("amplitudes".into(), Value::Integer(options.1)),
                            ]
                            .into()
                        } else {
                            [].into()
                        };
                        let solver = solvers::find(name).unwrap().configure(&list).unwrap();
                        let mut work = Workspace::new();
                        let mut best = f64::INFINITY;
                        let mut metrics = None;
                        for _ in 0..15 {
                            let t = Instant::now();
                            let s = solve(
                                &problem,
                                &*solver.solver,
                                solver.info.balance,
                                &mut work,
                                &mut Control::none(),
                            )
                            .unwrap();
                            best = best.min(t.elapsed().as_secs_f64());
                            metrics = Some(s.metrics());
                            work.recycle(s);
                        }
                        let q = metrics.unwrap();
                        println!(
                            "{level:8} {name} {options:?} N={n} M={m}: {:.1} us  {:.3} ns/NM (problem {:.1} us)  acc {:.4} sigma {:.4}",
                            best * 1e6,
                            best * 1e9 / (n * m) as f64,
                            prep * 1e6,
                            q.accuracy,
                            q.sigma
                        );
                    }
                }
            }
        }
    }
}
