//! Layouts against what a person would write, and lines that mean nothing.

use super::{DEEPEST, formula, stated};

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
fn equations_of_built_in_models_are_read_to_the_last_letter() {
    for (line, wanted) in [
        ("x' = y", "x˙=y"),
        (
            "z' = y - (λ |y| / f_c) z,   |z| ≤ f_c/λ",
            "z˙=y−{λ |y|}/{f_{c}} z,\u{2003}|z|≤{f_{c}}/{λ}",
        ),
        ("E[ξ(t) ξ(t+τ)] = σ² δ(τ)", "E[ξ(t) ξ(t+τ)]=σ^{2} δ(τ)"),
        ("dx = (a x - x³) dt + σ dW", "dx=(a x−x^{3}) dt+σ dW"),
        ("A y - β |y| |z|ⁿ⁻¹ z", "A y−β |y| |z|^{n−1} z"),
        ("|z| ≤ (A/(β + γ))^(1/n)", "|z|≤({A}/{β+γ})^{{1}/{n}}"),
        (
            "a(w) = 0 for w ≤ f_b,   1 beyond",
            "a(w)=0\u{a0}for\u{a0}w≤f_{b},\u{2003}1\u{a0}beyond\u{a0}",
        ),
        (
            "E[ξ_i(t) ξ_j(t+τ)] = δ_ij δ(τ), read as Itô",
            "E[ξ_{i}(t) ξ_{j}(t+τ)]=δ_{ij} δ(τ),\u{a0}read as Itô\u{a0}",
        ),
        (
            "C'' + ω_n² C = 0,   C'(0) = 0",
            "C¨+ω_{n}^{2} C=0,\u{2003}C˙(0)=0",
        ),
        ("H = y²/2 + μ x⁴/4", "H={y^{2}}/{2}+{μ x^{4}}/{4}"),
        ("exp(-|s|/τ)/(2 τ)", "{exp(−{|s|}/{τ})}/{2 τ}"),
    ] {
        assert_eq!(shape(&stated(line)), wanted, "{line}");
    }
}

#[test]
fn no_line_is_lost_and_none_is_too_much() {
    for line in [
        "",
        "x' = y ?? z",
        "|",
        "(",
        "a^",
        "√",
        "x = (1, 2",
        "Σ_k b_k",
        "<script>alert(1)</script> &",
    ] {
        let shown = shape(&stated(line));
        let letters = |text: &str| text.chars().filter(|c| c.is_alphanumeric()).count();
        assert_eq!(letters(&shown), letters(line), "{line}: {shown}");
        assert!(!stated(line).to_string().contains("<script"));
    }
    let nested = "(".repeat(3000) + "x" + &")".repeat(1000);
    let over = format!("x{}", "/2".repeat(2 * DEEPEST));
    let fractions = formula(&over).unwrap();
    assert_eq!((fractions.tag, shape(&fractions)), ("mtext", over.clone()));
    for line in [
        nested,
        "|".repeat(4000),
        over,
        "√".repeat(1000) + "x",
        "x ".repeat(5000),
    ] {
        assert!(!stated(&line).is_deeper_than(DEEPEST + 2));
    }
}
