//! How many processes have ended long before the mean time, with two axes.

use crate::common::room::Room;

#[test]
fn few_that_have_ended_early_are_known_within_their_errors() {
    let room = Room::new();
    // The distance from the middle is a process of its own, whose backward equation was solved with 2000 and 4000
    // elements: 5.6745e-4 have ended by 0.3, and 0.26837 by 1.5.
    let noise = "sqrt(2*0.1054*(1+0.3303*(x^2+y^2)))";
    let text = format!(
        "[system.equations]
x = \"a*x-x*(x^2+y^2)-0.586*y\"
y = \"a*y-y*(x^2+y^2)+0.586*x\"
[system.noise]
x = \"{noise}\"
y = \"{noise}\"
interpretation = \"ito\"
[sweep]
parameter = \"a\"
from = 1.0676
to = 1.1
points = 2
[cells]
x = {{ count = 60 }}
y = {{ count = 60 }}
[passage]
p = {{ start = {{ x = -0.2218, y = -0.2902 }}, until = \"x^2+y^2 > 1.985281\", times = [0.3, 1.5] }}
[locate]
effort = 0.0
[figures]
draw = []
"
    );
    room.write("a.toml", text);
    let _ = room.solved("sweep a.toml --out run");
    let row = &room.table("run/points.csv").0[0];
    for (time, ended, known_to) in [("0.3", 5.6745e-4, 1e-8), ("1.5", 0.26837, 1e-5)] {
        let columns = ["", "_error"].map(|end| format!("p_{time}_survival{end}"));
        let [value, error] = row.numbers([columns[0].as_str(), &columns[1]]);
        let off = (1.0 - value - ended).abs();
        assert!(off < error + known_to, "{time}: {value} ± {error}");
        assert!(error < 0.2 * ended, "{time}: {error}");
    }
}
