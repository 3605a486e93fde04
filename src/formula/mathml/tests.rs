//! Layouts against what a person would write, and what is none.

use super::{DEEPEST, correlation, equation, formula, words};

/// A layout in a short notation: `a/b` in braces, powers with `^`, lowered letters with `_`.
fn shape(element: &super::Element) -> String {
    use super::Content::{Elements, Text};
    let inner = match &element.content {
        Text(text) => return text.replace('\u{2062}', " ").replace('\u{2061}', ""),
        Elements(inner) => inner,
    };
    let parts: Vec<String> = inner.iter().map(shape).collect();
    match element.tag {
        "mfrac" => format!("{{{}}}/{{{}}}", parts[0], parts[1]),
        "msup" => format!("{}^{{{}}}", parts[0], parts[1]),
        "msub" => format!("{}_{{{}}}", parts[0], parts[1]),
        "msqrt" => format!("√{{{}}}", parts.concat()),
        "mroot" => format!("√[{}]{{{}}}", parts[1], parts[0]),
        "mtr" => format!("{};", parts.concat()),
        _ => parts.concat(),
    }
}

#[test]
fn formulas_are_laid_out_as_people_write_them() {
    for (text, wanted) in [
        (
            "-kappa y - x (alpha + mu x^2) - f_c sign(y)",
            "−κ y−x (α+μ x^{2})−f_{c} sgn(y)",
        ),
        ("sqrt(2*D1)*x", "√{2 D_{1}} x"),
        ("-x^2 + 2^3^2 + x^-1", "−x^{2}+2^{3^{2}}+x^{−1}"),
        ("(-x)^2", "(−x)^{2}"),
        ("-a*b/c", "−{a b}/{c}"),
        ("a/(b*c)/d", "{{a}/{b c}}/{d}"),
        ("(a + b)/(c - d)*e", "{a+b}/{c−d} e"),
        ("(a/b)^c", "({a}/{b})^{c}"),
        ("(x^2)^y", "(x^{2})^{y}"),
        ("a - (b - c) + (d*e)*f", "a−(b−c)+d e f"),
        ("a*(-b) + -c", "a (−b)+(−c)"),
        ("--a", "−(−a)"),
        ("2*3*x*0.5", "2·3 x·0.5"),
        ("2*3^x", "2·3^{x}"),
        ("2*(1/2)*x", "2·{1}/{2} x"),
        ("a*(1/2) - 3*(x/2)", "a {1}/{2}−3·{x}/{2}"),
        ("abs(x - 1)*floor(y) + cbrt(z)", "|x−1| ⌊y⌋+√[3]{z}"),
        ("pow(x, y + 1) + hypot(x, y)", "x^{y+1}+√{x^{2}+y^{2}}"),
        ("min(x, y, 1) - log10(x)", "min(x,y,1)−log_{10}(x)"),
        ("exp(-(u/v_s)²)", "exp(−({u}/{v_{s}})^{2})"),
        ("(x < y)*3", "(x<y)·3"),
        ("if(x >= 0, 1, -x)", "{1\u{2003}if x≥0;−x\u{2003}otherwise;"),
        ("1e-7*x + 2.5e12 - 0.1", "10^{−7} x+2.5×10^{12}−0.1"),
        ("eps*omega_0 + a_1_2 + pi", "eps ω_{0}+a_{1,2}+π"),
    ] {
        assert_eq!(shape(&formula(text).unwrap()), wanted, "{text}");
    }
}

#[test]
fn equations_have_dots_relations_and_noises() {
    let noises = [("σ".to_owned(), "ξ".to_owned())];
    let drift = equation("z'", "=", "y - (λ abs(y)/f_c) z", &noises);
    assert_eq!(shape(&drift.unwrap()), "z˙=y−{λ |y|}/{f_{c}} z+σ ξ(t)");
    let bound = equation("abs(z)", "≤", "(A/(β + γ))^(1/n)", &[]);
    assert_eq!(shape(&bound.unwrap()), "|z|≤({A}/{β+γ})^{{1}/{n}}");
    assert_eq!(
        shape(&correlation(["ξ_i", "ξ_j"], "δ_ij", "τ", ", read as Itô")),
        "E[ξ_{i}(t) ξ_{j}(t+τ)]=δ_{ij} δ(τ), read as Itô"
    );
    assert_eq!(
        shape(&correlation(["w", "w"], "", "s", "")),
        "E[w(t) w(t+s)]=δ(s)"
    );
}

#[test]
fn what_is_too_deep_stays_text() {
    let over = format!("x{}", "/2".repeat(2 * DEEPEST));
    let fractions = formula(&over).unwrap();
    assert_eq!((fractions.tag, shape(&fractions)), ("mtext", over));
    let markup = words("<script>alert(1)</script> &").to_string();
    assert_eq!(
        markup,
        "<mtext>&lt;script&gt;alert(1)&lt;/script&gt; &amp;</mtext>"
    );
}
