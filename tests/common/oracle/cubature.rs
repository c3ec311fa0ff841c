//! An integral over a rectangle with an estimate of its error, by 17 points.
//!
//! Genz and Malik 1980, "An adaptive algorithm for numerical integration over an N-dimensional
//! rectangular region", for N = 2: a rule of degree 7 and one of degree 5 on the same points, whose
//! difference is the estimate; fourth differences say which axis to halve.

/// What one rectangle gave.
#[derive(Debug, Clone, Copy)]
pub struct Sum {
    /// The integral over the rectangle, by the rule of degree 7.
    pub value: [f64; 3],
    /// The difference to the rule of degree 5, which is an upper bound wherever the integrand is
    /// smooth at the rectangle's size.
    pub error: [f64; 3],
    /// The axis along which the integrand bends most: 0 or 1.
    pub axis: usize,
}

/// Evaluations that one call takes.
pub const POINTS: u64 = 17;

fn add(total: &mut [f64; 3], value: [f64; 3]) {
    total.iter_mut().zip(value).for_each(|(total, value)| *total += value);
}

/// Integrates `f` over [x0, x1] x [y0, y1].
pub fn integrate(x: [f64; 2], y: [f64; 2], f: impl Fn(f64, f64) -> [f64; 3]) -> Sum {
    let (mid, half) =
        ([0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])], [0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])]);
    let at = |a: f64, b: f64| f(mid[0] + a * half[0], mid[1] + b * half[1]);
    let near = f64::sqrt(9.0 / 70.0);
    let far = f64::sqrt(9.0 / 10.0);
    let corner = f64::sqrt(9.0 / 19.0);

    // The centre, two pairs of points on each axis, four on each pair of diagonals.
    let centre = at(0.0, 0.0);
    let (mut sum_near, mut sum_far) = ([0.0; 3], [0.0; 3]);
    let mut bend = [0.0; 2];
    for (axis, bend) in bend.iter_mut().enumerate() {
        let along = |r: f64| if axis == 0 { at(r, 0.0) } else { at(0.0, r) };
        let (mut pair_near, mut pair_far) = (along(near), along(far));
        add(&mut pair_near, along(-near));
        add(&mut pair_far, along(-far));
        for c in 0..3 {
            let twice = 2.0 * centre[c];
            *bend += (pair_near[c] - twice - (pair_far[c] - twice) / 7.0).abs();
        }
        add(&mut sum_near, pair_near);
        add(&mut sum_far, pair_far);
    }
    let diagonal = |r: f64| {
        let mut sum = [0.0; 3];
        [at(r, r), at(r, -r), at(-r, r), at(-r, -r)].into_iter().for_each(|v| add(&mut sum, v));
        sum
    };
    let (outer, inner) = (diagonal(far), diagonal(corner));

    // Table 1 of the paper at N = 2, divided by the area 4 of the unit square.
    let area = 4.0 * half[0] * half[1];
    let seventh = |c: usize| {
        (-3816.0 * centre[c] + 2940.0 * sum_near[c] + 1020.0 * sum_far[c] + 200.0 * outer[c])
            / 19683.0
            + 6859.0 / 78732.0 * inner[c]
    };
    let fifth = |c: usize| {
        (-1942.0 * centre[c] + 735.0 * sum_near[c] + 65.0 * sum_far[c] + 50.0 * outer[c]) / 1458.0
    };
    let value = std::array::from_fn(|c| area * seventh(c));
    let error = std::array::from_fn(|c| (area * (seventh(c) - fifth(c))).abs());
    let axis = if bend[0] == bend[1] {
        usize::from(half[1] > half[0])
    } else {
        usize::from(bend[1] > bend[0])
    };
    Sum { value, error, axis }
}
