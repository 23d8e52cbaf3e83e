//! Shares of the corners of a triangle in the samples of its rows.

/// Share of a corner of a triangle, in all of its rows of samples.
#[derive(Clone, Copy)]
pub(super) struct Share {
    /// At column and row zero, over the scale.
    origin: f64,
    /// From row to row, over the scale.
    per_row: f64,
    /// From column to column, over the scale.
    pub(super) per_column: f64,
    /// One over that.
    columns: f64,
    scale: f64,
}

impl Share {
    /// Share of the corner opposite to the edge from `p` to `q`.
    ///
    /// - `scale`: one over twice the area of the triangle
    #[inline(always)]
    pub(super) fn of_corner(p: [f64; 3], q: [f64; 3], scale: f64) -> Self {
        // Samples lie at the middle of their cells. Turning the edge round changes signs and nothing else.
        let [p, q] = [p, q].map(|[x, y, _]| [x - 0.5, y - 0.5]);
        let per_column = p[1] - q[1];
        Share { origin: p[0] * q[1] - p[1] * q[0], per_row: q[0] - p[0], per_column, columns: 1.0 / per_column, scale }
    }

    #[inline(always)]
    pub(super) fn in_row(self, row: usize) -> RowShare {
        RowShare { of: self, start: self.origin + self.per_row * row as f64 }
    }
}

/// Share of a corner along a row of samples.
#[derive(Clone, Copy)]
pub(super) struct RowShare {
    of: Share,
    /// At the first column, over the scale.
    start: f64,
}

impl RowShare {
    #[inline(always)]
    pub(super) fn at(self, column: usize) -> f64 {
        // Scaled last: two triangles with a common edge agree to the last bit on which side of it a sample lies.
        self.of.scale * (self.start + self.of.per_column * column as f64)
    }

    /// Column at which it is that, over the scale.
    #[inline(always)]
    pub(super) fn column(self, scaled: f64) -> f64 {
        (scaled - self.start) * self.of.columns
    }
}

/// Columns of a row at which every share reaches `least`, within `slack` columns.
#[inline(always)]
pub(super) fn reaching(shares: &[RowShare; 3], least: [f64; 3], [left, right]: [usize; 2], slack: f64) -> [usize; 2] {
    let (mut low, mut high) = (left as f64, right as f64);
    for (share, least) in shares.iter().zip(least) {
        let Share { per_column, scale, .. } = share.of;
        if per_column == 0.0 {
            if share.start * scale < least {
                return [left, left];
            }
        } else if per_column * scale > 0.0 {
            low = low.max(share.column(least / scale) - slack);
        } else {
            high = high.min(share.column(least / scale) + 1.0 + slack);
        }
    }
    // What is not a number leaves the bounds as they are.
    let left = (low as usize).min(right);
    [left, (high.max(0.0) as usize).clamp(left, right)]
}

/// Columns of a row at which no share is negative: between them none is, since rounding keeps the order of shares.
#[inline(always)]
pub(super) fn span(shares: &[RowShare; 3], within: [usize; 2]) -> [usize; 2] {
    let outside = |column: usize| shares.iter().any(|share| share.at(column) < 0.0);
    let [mut left, mut right] = reaching(shares, [0.0; 3], within, 1.0);
    while left < right && outside(left) {
        left += 1;
    }
    while left < right && outside(right - 1) {
        right -= 1;
    }
    [left, right]
}
