//! The shift of the world that offsets of cameras hide: draws of it are calibrated.

use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_observe::Camera;
use sinew_observe::common_shift::CommonShift;

fn ring(n: usize) -> Vec<Camera> {
    (0..n)
        .map(|i| {
            let angle = 0.4 + std::f64::consts::TAU * i as f64 / n as f64;
            let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 1.8];
            Camera::look_at(&format!("C{i}"), [1000.0, 1000.0], 1000.0, centre, [0.0, 0.0, 1.0]).expect("a view")
        })
        .collect()
}

/// Rigs whose offsets are drawn as the prior says: the rank of the true shift, 0, among draws is uniform on every axis. χ² of ten cells, false alarm 1e-6 each.
#[test]
fn shifts_are_drawn_from_their_posterior() {
    const RIGS: usize = 600;
    for cameras in [ring(2), ring(4), ring(6)] {
        let mut cells = [[0.0; 10]; 3];
        for rig in 0..RIGS {
            let stage = |verb| Stage::new(rig as u64, verb);
            let mut normal = [Block::ZERO; 9];
            stage("rig").whole().fill_normal(Isa::baseline(), &mut normal);
            let z = |k: usize| normal[k / 8].0[k % 8];
            let tau = 0.003 * z(0).exp();
            // Student's t with four degrees of freedom: over the root of a mean of four squares.
            let offset = |c: usize| {
                let square = (0..4).map(|k| z(1 + 6 * c + k).powi(2)).sum::<f64>() / 4.0;
                [4, 5].map(|k| 1000.0 * tau * z(1 + 6 * c + k) / square.sqrt())
            };
            let offsets: Vec<[f64; 2]> = (0..cameras.len()).map(offset).collect();
            let common = CommonShift::new(&cameras, &offsets, [0.1, -0.2, 1.0]).expect("two cameras or more");
            let draws = common.draws(99, stage("shift"));
            for (axis, cells) in cells.iter_mut().enumerate() {
                cells[draws.iter().filter(|draw| draw[axis] < 0.0).count() / 10] += 1.0;
            }
        }
        for cells in cells {
            let expected = RIGS as f64 / 10.0;
            let square: f64 = cells.iter().map(|cell| (cell - expected).powi(2) / expected).sum();
            assert!(square < 45.1, "{} cameras: {cells:?}", cameras.len());
        }
    }
    assert!(CommonShift::new(&ring(1), &[[3.0, 0.0]], [0.1, -0.2, 1.0]).is_none());
}
