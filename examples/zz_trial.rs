use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource;
use pbif::density::Observable;
use pbif::method::*;
use pbif::space::*;
use pbif::system::*;
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let get = |i: usize, d: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(d);
    let (nx, ny, n) = (get(1, 50.0) as usize, get(2, 40.0) as usize, get(3, 6.0) as usize);
    let l = get(4, 2.5);
    let (lam, fc) = (get(5, 0.06), get(6, 0.05));
    let model = registry::find("dahl").unwrap();
    let fam = Family::new(model, &[("kappa",0.02),("mu",1.0),("lambda",lam),("f_c",fc),("sigma2",0.02)], Path::parameter("alpha",-1.0,0.5)).unwrap();
    let zm = fc / lam;
    let x = Axis::uniform(-l, l, nx).unwrap();
    let y = Axis::uniform(-l, l, ny).unwrap();
    let z = Axis::modes(-zm, zm, n).unwrap();
    let space = CellSpace::new(vec![x, y, z]).unwrap();
    let p = Problem::new(fam, space, vec![Observable::Marginal(0), Observable::Marginal(1), Observable::Joint(0,1)]).unwrap();
    for scheme in [pbif::generator::AdvectiveScheme::Upwind5, pbif::generator::AdvectiveScheme::Central4] {
    let o = GeneratorMethodOptions { scheme, ..Default::default() };
    let s = GeneratorSource::new(&p, &o).unwrap();
    let mut session = s.open(&Cancellation::new());
    for a in [-1.0, -0.975, -0.95, -0.925, -0.9, -0.875, -0.85, 0.5] {
        let t = Instant::now();
        let sol = session.solve(a).unwrap();
        let m: Vec<f64> = sol.moments.iter().map(|m| m.standard_deviation.powi(2)).collect();
        let e = |i: usize| sol.densities[i].standard_error.iter().fold(0.0f64, |a,b| a.max(*b)) / sol.densities[i].density.maximum();
        println!("{scheme:?} {a} {:.5?} it {} fac {} neg {:.1e} err {:.1e} {:.1e} {:.1e} {:?} t {:.3}", m, sol.report.iterations, sol.report.own.factorisations, sol.report.own.negative_mass, e(0), e(1), e(2), sol.report.status, t.elapsed().as_secs_f64());
    }
    }
}
