//! Precedence, implicit products, and where faults are pointed at.

use super::*;

/// The formula with every operation in parentheses.
fn grouped(text: &str) -> String {
    let syntax = parse(text).unwrap_or_else(|error| panic!("{}", error.drawn(text)));
    let mut shown: Vec<String> = Vec::new();
    for node in &syntax.nodes {
        let of = |node: u32| shown[node as usize].clone();
        let next = match node.kind {
            SyntaxKind::Number(value) => value.to_string(),
            SyntaxKind::Name(start, end) => text[start as usize..end as usize].to_owned(),
            SyntaxKind::Negate(inner) => format!("(-{})", of(inner)),
            SyntaxKind::Binary(operator, left, right) => {
                let sign = match operator {
                    Operator::Add => "+",
                    Operator::Subtract => "-",
                    Operator::Multiply => "*",
                    Operator::Divide => "/",
                    Operator::Power => "^",
                    Operator::Less => "<",
                    Operator::LessOrEqual => "<=",
                    Operator::Greater => ">",
                    Operator::GreaterOrEqual => ">=",
                    Operator::Equal => "==",
                    Operator::NotEqual => "!=",
                };
                format!("({}{sign}{})", of(left), of(right))
            }
            SyntaxKind::Call(function, first, count) => {
                let arguments = syntax.arguments_of(first, count);
                let arguments: Vec<String> = arguments.iter().map(|&node| of(node)).collect();
                format!("{}({})", function.name(), arguments.join(","))
            }
        };
        shown.push(next);
    }
    shown.pop().unwrap_or_default()
}

fn fault(text: &str) -> (&str, Fault) {
    match parse(text) {
        Err(error) => (&text[error.span], error.fault),
        Ok(_) => panic!("{text} is read as {}", grouped(text)),
    }
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("a + b*c - d/e", "((a+(b*c))-(d/e))"),
        ("-x^2", "(-(x^2))"),
        ("2^3^2", "(2^(3^2))"),
        ("2^-1", "(2^(-1))"),
        ("2^-x^2", "(2^(-(x^2)))"),
        ("a - b - c", "((a-b)-c)"),
        ("a/b/c", "((a/b)/c)"),
        ("a/b*c", "((a/b)*c)"),
        ("a*-b", "(a*(-b))"),
        ("--a + +b", "((-(-a))+b)"),
        ("a < b + 1", "(a<(b+1))"),
        ("(a < b)*(c >= d)", "((a<b)*(c>=d))"),
        ("-a*b", "((-a)*b)"),
        ("x²", "(x^2)"),
        ("-x²", "(-(x^2))"),
        ("2^x²", "(2^(x^2))"),
        ("(x + 1)³ y", "(((x+1)^3)*y)"),
        ("min(a, b, c)^2", "(min(a,b,c)^2)"),
        ("if(x > 0, 1, -1)", "if((x>0),1,(-1))"),
        ("sgn(x) + ln(y)", "(sign(x)+log(y))"),
    ] {
        assert_eq!(grouped(text), expected, "{text}");
    }
}

#[test]
fn products_may_do_without_a_sign_where_they_cannot_be_misread() {
    for (text, expected) in [
        ("2 x", "(2*x)"),
        ("2x", "(2*x)"),
        ("2(x + 1)", "(2*(x+1))"),
        ("(a)(b)", "(a*b)"),
        ("(a) b", "(a*b)"),
        ("(a)b", "(a*b)"),
        ("c1 x^2", "(c1*(x^2))"),
        ("a b c", "((a*b)*c)"),
        ("a (b + c)", "(a*(b+c))"),
        ("w^2 x^2/2", "(((w^2)*(x^2))/2)"),
        ("σ²x", "((σ^2)*x)"),
        ("x^2 y", "((x^2)*y)"),
        ("x^(2)y", "((x^2)*y)"),
        ("2 sin(x) cos(y)", "((2*sin(x))*cos(y))"),
        ("2exp(x)", "(2*exp(x))"),
        ("a/b*c d", "(((a/b)*c)*d)"),
        ("a b/c", "((a*b)/c)"),
        (
            "-(c0 + c1 x^2) y - w^2 x",
            "(((-(c0+(c1*(x^2))))*y)-((w^2)*x))",
        ),
        (
            "-kappa y - x (alpha + mu x^2)",
            "(((-kappa)*y)-(x*(alpha+(mu*(x^2)))))",
        ),
        ("sin (x)", "sin(x)"),
    ] {
        assert_eq!(grouped(text), expected, "{text}");
    }
}

#[test]
fn products_that_can_be_misread_are_refused() {
    for (text, at, expected) in [
        ("1/2 x", "x", Fault::ProductAfterDivision),
        ("a/b(c)", "b", not_a_function("b")),
        ("a/b (c)", "(", Fault::ProductAfterDivision),
        ("x^2y", "y", Fault::ProductAfterExponent),
        ("x^2(y)", "(", Fault::ProductAfterExponent),
        ("f_c(x)", "f_c", not_a_function("f_c")),
        ("x 2", "2", Fault::NumberAfterFactor),
        ("2 3", "3", Fault::NumberAfterFactor),
        ("(a) 2", "2", Fault::NumberAfterFactor),
        ("x²^3", "^", Fault::TwoExponents),
        ("x^2²³ ²", "²", Fault::TwoExponents),
    ] {
        assert_eq!(fault(text), (at, expected), "{text}");
    }
}

fn not_a_function(name: &str) -> Fault {
    Fault::NotAFunction {
        name: name.to_owned(),
        is: None,
        nearest: None,
    }
}

#[test]
fn faults_are_pointed_at() {
    let operand = |found: &str| Fault::Operand {
        found: found.to_owned(),
    };
    let operator = |found: &str| Fault::Operator {
        found: found.to_owned(),
    };
    for (text, at, expected) in [
        ("", "", Fault::Empty),
        (" \t\n", " \t\n", Fault::Empty),
        ("x +", "", operand("the end")),
        ("x + * y", "*", operand("`*`")),
        ("()", ")", operand("`)`")),
        ("(x + y", "(", Fault::Unclosed),
        ("sin(x", "(", Fault::Unclosed),
        ("x + y)", ")", operator("`)`")),
        ("1,5 x", ",", Fault::Comma { decimal: true }),
        ("(x, y)", ",", Fault::Comma { decimal: false }),
        (
            "sin x",
            "sin",
            Fault::Parentheses {
                function: Function::Sin,
            },
        ),
        (
            "sin",
            "sin",
            Fault::Parentheses {
                function: Function::Sin,
            },
        ),
        (
            "sin^2(x)",
            "sin",
            Fault::PowerOfName {
                function: Function::Sin,
            },
        ),
        (
            "sin²(x)",
            "sin",
            Fault::PowerOfName {
                function: Function::Sin,
            },
        ),
        ("a < b < c", "<", Fault::Chained),
        ("²x", "²", operand("`²`")),
    ] {
        assert_eq!(fault(text), (at, expected), "{text}");
    }
    for (text, function, given) in [
        ("sin()", Function::Sin, 0),
        ("sin(1,5)", Function::Sin, 2),
        ("min(x)", Function::Min, 1),
        ("if(x, y)", Function::If, 2),
        ("log(x, 10)", Function::Log, 2),
        ("atan2(y)", Function::Atan2, 1),
    ] {
        assert_eq!(fault(text), (text, Fault::Arguments { function, given }));
    }
}

#[test]
fn a_fault_is_drawn_below_its_line() {
    let text = "y +\n  sin x + 1";
    let drawn = parse(text).unwrap_err().drawn(text);
    assert_eq!(
        drawn,
        "    sin x + 1\n    ^^^ the function `sin` needs its argument in parentheses\n    write sin(x)"
    );
}

#[test]
fn depth_and_length_are_bounded() {
    let deep =
        |left: &str, right: &str| format!("{}x{}", left.repeat(100_000), right.repeat(100_000));
    let short =
        |left: &str, right: &str| format!("{}x{}", left.repeat(20_000), right.repeat(20_000));
    for text in [deep("(", ")"), "x".repeat(1 << 20), deep("-", "")] {
        assert!(matches!(
            parse(&text).unwrap_err().fault,
            Fault::TooLong { .. }
        ));
    }
    for text in [
        short("(", ")"),
        short("-", ""),
        short("", "^x"),
        short("sin(", ")"),
        short("2^-", ""),
    ] {
        let text = if text.len() > limits::FORMULA_BYTES {
            text[..limits::FORMULA_BYTES].to_owned()
        } else {
            text
        };
        assert_eq!(
            parse(&text).unwrap_err().fault,
            Fault::TooDeep,
            "{}",
            &text[..20]
        );
    }
    // Long is not deep.
    assert!(parse(&short("", "+x")).is_ok());
    assert!(parse(&short("", " x")).is_ok());
    let at_the_limit = format!(
        "{}x{}",
        "(".repeat(limits::NESTING),
        ")".repeat(limits::NESTING)
    );
    assert!(parse(&at_the_limit).is_ok());
}
