use pbif::cancellation::Cancellation;
use pbif::continuation::DensitySource;
use pbif::density::Observable;
use pbif::method::*;
use pbif::space::*;
use pbif::system::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let get = |i: usize, d: f64| args.get(i).and_then(|a| a.parse().ok()).unwrap_or(d);
    let (nx, ny) = (get(1, 32.0) as usize, get(2, 32.0) as usize);
    let (lam, fc) = (get(3, 0.06), get(4, 0.05));
    let a = get(5, 0.5);
    let model = registry::find("dahl").unwrap();
    let mut before: Option<Vec<Vec<f64>>> = None;
    for n in [2, 3, 4, 5, 6, 8, 12, 16] {
    let fam = Family::new(model.clone(), &[("kappa",0.02),("mu",1.0),("lambda",lam),("f_c",fc),("sigma2",0.02)], Path::parameter("alpha",-1.0,0.5)).unwrap();
    let zm = fc / lam;
    let l = 2.5;
    let x = Axis::uniform(-l, l, nx).unwrap();
    let y = Axis::uniform(-l, l, ny).unwrap();
    let z = Axis::modes(-zm, zm, n).unwrap();
    let space = CellSpace::new(vec![x, y, z]).unwrap();
    let p = Problem::new(fam, space, vec![Observable::Marginal(0), Observable::Marginal(1), Observable::Joint(0,1)]).unwrap();
    let o = GeneratorMethodOptions::default();
    let s = GeneratorSource::new(&p, &o).unwrap();
    let mut session = s.open(&Cancellation::new());
        let sol = session.solve(a).unwrap();
        let now: Vec<Vec<f64>> = sol.densities.iter().map(|d| d.density.values.clone()).collect();
        let m: Vec<f64> = sol.moments.iter().map(|m| m.standard_deviation.powi(2)).collect();
        let mut c = vec![];
        let mut at = 0;
        if let Some(b) = &before { for (a, b) in b.iter().zip(&now) {
            let l = b.iter().cloned().fold(0.0, f64::max);
            let d: Vec<f64> = a.iter().zip(b).map(|(a,b)| (a-b).abs()/l).collect();
            let mx = d.iter().cloned().fold(0.0, f64::max);
            at = d.iter().position(|v| *v == mx).unwrap();
            c.push(mx);
        } }
        println!("{n} {m:.6?} change {:?} at {} {}", c.iter().map(|c| format!("{c:.1e}")).collect::<Vec<_>>(), at / ny, at % ny);
        before = Some(now);
    }
}
