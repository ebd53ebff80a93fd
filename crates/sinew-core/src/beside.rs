//! A decoder of some coordinates of a state, beside others that pass unchanged.
//!
//! For instance of a latent pose, beside a place and a heading that no latent space holds.
//!
//! The decoded state is [λ, ω], λ of `free` coordinates; the decoder writes the coordinates of ω that it was made for. The sampled state is [λ, θ, ρ]: θ is decoded, ρ is the rest of ω in ascending order.

use crate::Error;
use crate::decode::Decode;
use crate::lanes::{Block, triangle};
use crate::part::Part;

/// The decoder. Law: all laws of [`Decode`], if the decoder of θ keeps them.
#[derive(Clone, Debug)]
pub struct Beside<C> {
    decoder: C,
    free: usize,
    /// Where the decoder's coordinates go, in its order.
    decoded: Vec<usize>,
    /// Where λ and ρ go, ascending.
    passed: Vec<usize>,
}

impl<C: Decode> Beside<C> {
    /// λ of `free` coordinates, then ω of `pose_dim`, of which the decoder writes `coordinates`, in this order.
    ///
    /// # Errors
    /// [`Error::Dimension`] where the decoder has another number of coordinates, and what [`Part::new`] refuses.
    pub fn new(free: usize, decoder: C, coordinates: &[usize], pose_dim: usize) -> Result<Self, Error> {
        if decoder.target_dim() != coordinates.len() {
            let (found, expected) = (decoder.target_dim(), coordinates.len());
            return Err(Error::Dimension { name: "decoder", found, expected });
        }
        let part = Part::new(coordinates.to_vec(), pose_dim)?;
        let rest = (0..pose_dim).filter(|index| part.indices().binary_search(index).is_err());
        let passed = (0..free).chain(rest.map(|index| free + index)).collect();
        Ok(Self { decoder, free, decoded: coordinates.iter().map(|index| free + index).collect(), passed })
    }

    /// λ of `free` coordinates, then all that the decoder writes.
    ///
    /// # Errors
    /// [`Error::EmptyPart`] where it writes nothing.
    pub fn whole(free: usize, decoder: C) -> Result<Self, Error> {
        let dim = decoder.target_dim();
        Self::new(free, decoder, &(0..dim).collect::<Vec<_>>(), dim)
    }

    /// The decoder of θ.
    pub fn decoder(&self) -> &C {
        &self.decoder
    }

    /// Where θ stands in a sampled state.
    #[must_use]
    pub fn latent(&self) -> core::ops::Range<usize> {
        self.free..self.free + self.decoder.source_dim()
    }

    /// Writes λ and ρ of a sampled state from the decoded one.
    pub fn pass<T: Copy>(&self, decoded: &[T], sampled: &mut [T]) {
        self.pairs().for_each(|(from, to)| sampled[from] = decoded[to]);
    }

    /// What passes: its places in the sampled and in the decoded state.
    fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + Clone {
        let latents = self.decoder.source_dim();
        let place = move |(k, &to): (usize, &usize)| (if k < self.free { k } else { k + latents }, to);
        self.passed.iter().enumerate().map(place)
    }
}

impl<C: Decode> Decode for Beside<C> {
    fn source_dim(&self) -> usize {
        self.passed.len() + self.decoder.source_dim()
    }
    fn target_dim(&self) -> usize {
        self.passed.len() + self.decoded.len()
    }
    fn workspace(&self) -> usize {
        self.decoded.len() + self.decoder.workspace()
    }
    fn matrix_workspace(&self) -> usize {
        let (m, n) = (self.decoded.len(), self.decoder.source_dim());
        triangle(m, 0) + triangle(n, 0) + m + n + self.decoder.matrix_workspace().max(self.decoder.workspace())
    }
    fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let (decoded, ws) = ws.split_at_mut(self.decoded.len());
        self.decoder.decode_block(&x[self.latent()], decoded, ws);
        self.decoded.iter().zip(decoded).for_each(|(&to, y)| out[to] = *y);
        self.pairs().for_each(|(from, to)| out[to] = x[from]);
    }
    fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
        let (decoded, ws) = ws.split_at_mut(self.decoded.len());
        self.decoded.iter().zip(&mut *decoded).for_each(|(&to, g)| *g = grad_out[to]);
        self.decoder.pullback_block(&x[self.latent()], decoded, &mut grad[self.latent()], ws);
        self.pass(grad_out, grad);
    }

    /// The decoder's own matrix for θ, and one pullback for each coordinate that passes.
    fn pullback_matrix_block(&self, x: &[Block], matrix_out: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (m, n, theta) = (self.decoded.len(), self.decoder.source_dim(), &x[self.latent()]);
        let symmetric = |a: usize, b: usize| triangle(a.max(b), a.min(b));
        let (target_matrix, ws) = ws.split_at_mut(triangle(m, 0));
        let (latent_matrix, ws) = ws.split_at_mut(triangle(n, 0));
        let (row, ws) = ws.split_at_mut(m);
        let (pulled, ws) = ws.split_at_mut(n);
        for (a, &i) in self.decoded.iter().enumerate() {
            for (b, &k) in self.decoded[..=a].iter().enumerate() {
                target_matrix[triangle(a, b)] = matrix_out[symmetric(i, k)];
            }
        }
        self.decoder.pullback_matrix_block(theta, target_matrix, latent_matrix, ws);
        for a in 0..n {
            for b in 0..=a {
                matrix[triangle(self.free + a, self.free + b)] = latent_matrix[triangle(a, b)];
            }
        }
        for (from, to) in self.pairs() {
            self.decoded.iter().zip(&mut *row).for_each(|(&k, h)| *h = matrix_out[symmetric(to, k)]);
            self.decoder.pullback_block(theta, row, pulled, ws);
            pulled.iter().enumerate().for_each(|(a, h)| matrix[symmetric(from, self.free + a)] = *h);
            for (other, k) in self.pairs().take_while(|(other, _)| *other <= from) {
                matrix[triangle(from, other)] = matrix_out[symmetric(to, k)];
            }
        }
    }
    fn is_coordinatewise(&self) -> bool {
        self.decoder.is_coordinatewise() && self.decoded.iter().enumerate().all(|(k, &to)| to == self.free + k)
    }
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        let theta = self.decoder.encode(&self.decoded.iter().map(|&to| decoded[to]).collect::<Vec<_>>())?;
        let mut sampled = vec![0.0; self.source_dim()];
        self.pass(decoded, &mut sampled);
        sampled[self.latent()].copy_from_slice(&theta);
        Some(sampled)
    }
}
