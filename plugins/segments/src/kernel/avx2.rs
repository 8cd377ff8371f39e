//! Loops for AVX2. In intrinsics: the compiler makes no vectors of the transposition, and of the
//! rest only in some places.

use std::arch::x86_64::*;

use crate::channel;
use crate::kernel::portable::{between, look_up_motion, scattered_from};
use crate::kernel::{Output, States};
use crate::lattice::Lattice;
use crate::nodes::{LANES, Nodes, Row};

/// Numbers in one vector; hypotheses in one block.
const WIDTH: usize = 8;
const _: () = assert!(
    LANES == WIDTH,
    "a block of hypotheses is transposed as a square"
);

/// See [`BetweenEach`](super::BetweenEach).
#[target_feature(enable = "avx2")]
pub(super) fn between_each(low: &[f32], high: &[f32], fraction: f32, out: &mut [f32]) {
    let (low_blocks, high_blocks) = (low.as_chunks().0, high.as_chunks().0);
    let out_blocks = out.as_chunks_mut().0;
    let fractions = _mm256_set1_ps(fraction);
    for ((out, low), high) in out_blocks.iter_mut().zip(low_blocks).zip(high_blocks) {
        store(out, between_vectors(load(low), load(high), fractions));
    }
    // The last vector overlaps the one before it where the length is no multiple of a vector's.
    if let (Some(low), Some(high), Some(out)) =
        (low.last_chunk(), high.last_chunk(), out.last_chunk_mut())
    {
        store(out, between_vectors(load(low), load(high), fractions));
    } else {
        for ((out, &low), &high) in out.iter_mut().zip(low).zip(high) {
            *out = between(low, high, fraction);
        }
    }
}

/// See [`Kernel::scattered`](super::Kernel::scattered).
#[target_feature(enable = "avx2")]
pub(super) fn scattered(
    lattice: &Lattice,
    nodes: &Nodes,
    states: States<'_>,
    output: &mut Output<'_>,
) -> bool {
    let count = states.after.len();
    let blocks = states
        .before
        .as_chunks()
        .0
        .iter()
        .zip(states.after.as_chunks().0);
    let mut all_numbers = true;
    let mut start = 0;
    for (before, after) in blocks {
        all_numbers &= are_numbers(before, after);
        let lanes = transposed(look_up_block(&nodes.rows, &locate(lattice, after)));
        for channel in 0..channel::COUNT {
            store_at(output.mean, channel * count + start, lanes[channel]);
            store_at(
                output.sigma,
                channel * count + start,
                lanes[channel::COUNT + channel],
            );
        }
        let places = locate(lattice, before);
        let motion = &mut output.mean[channel::MOTION * count + start..][..WIDTH];
        for (i, motion) in motion.iter_mut().enumerate() {
            *motion = look_up_motion(&nodes.rows, (places.nodes[i], places.fractions[i]));
        }
        start += WIDTH;
    }
    all_numbers & scattered_from(start, lattice, nodes, states, output)
}

#[target_feature(enable = "avx2")]
fn are_numbers(before: &[f32; WIDTH], after: &[f32; WIDTH]) -> bool {
    let nan = _mm256_cmp_ps::<_CMP_UNORD_Q>(load(before), load(after));
    _mm256_movemask_ps(nan) == 0
}

/// Where the states of a block lie among the nodes.
struct Places {
    nodes: [u32; WIDTH],
    fractions: [f32; WIDTH],
}

/// As [`Lattice::locate`], for which NaN also gives node 0.
#[inline]
#[target_feature(enable = "avx2")]
fn locate(lattice: &Lattice, states: &[f32; WIDTH]) -> Places {
    let states = load(states);
    let (node0, fraction0) = locate_half(lattice, _mm256_castps256_ps128(states));
    let (node1, fraction1) = locate_half(lattice, _mm256_extractf128_ps::<1>(states));
    let mut places = Places {
        nodes: [0; WIDTH],
        fractions: [0.0; WIDTH],
    };
    store(&mut places.fractions, _mm256_set_m128(fraction1, fraction0));
    let nodes = _mm256_set_m128i(node1, node0);
    // SAFETY: writes eight u32, which the array has; no alignment is asked for.
    unsafe { _mm256_storeu_si256(places.nodes.as_mut_ptr().cast(), nodes) };
    places
}

#[inline]
#[target_feature(enable = "avx2")]
fn locate_half(lattice: &Lattice, states: __m128) -> (__m128i, __m128) {
    let from_lower = _mm256_sub_pd(_mm256_cvtps_pd(states), _mm256_set1_pd(lattice.lower));
    let place = _mm256_mul_pd(from_lower, _mm256_set1_pd(lattice.nodes_per_state));
    // Where one operand is NaN, this maximum is its second.
    let place = _mm256_max_pd(place, _mm256_setzero_pd());
    let place = _mm256_min_pd(place, _mm256_set1_pd(lattice.last as f64));
    let node = _mm256_cvttpd_epi32(place);
    let fraction = _mm256_sub_pd(place, _mm256_cvtepi32_pd(node));
    (node, _mm256_cvtpd_ps(fraction))
}

/// One row for each state.
#[inline]
#[target_feature(enable = "avx2")]
fn look_up_block(rows: &[Row], places: &Places) -> [__m256; WIDTH] {
    let mut block = [_mm256_setzero_ps(); WIDTH];
    for i in 0..WIDTH {
        let pair = &rows[places.nodes[i] as usize..][..2];
        let fraction = _mm256_set1_ps(places.fractions[i]);
        block[i] = between_vectors(load(&pair[0]), load(&pair[1]), fraction);
    }
    block
}

/// Rows become columns: pairs, then fours, then the halves of the vectors change places.
#[inline]
#[target_feature(enable = "avx2")]
fn transposed(r: [__m256; WIDTH]) -> [__m256; WIDTH] {
    let mut pairs = r;
    let mut fours = r;
    for i in 0..WIDTH / 2 {
        pairs[2 * i] = _mm256_unpacklo_ps(r[2 * i], r[2 * i + 1]);
        pairs[2 * i + 1] = _mm256_unpackhi_ps(r[2 * i], r[2 * i + 1]);
    }
    for half in [0, 4] {
        fours[half] = _mm256_shuffle_ps::<0x44>(pairs[half], pairs[half + 2]);
        fours[half + 1] = _mm256_shuffle_ps::<0xee>(pairs[half], pairs[half + 2]);
        fours[half + 2] = _mm256_shuffle_ps::<0x44>(pairs[half + 1], pairs[half + 3]);
        fours[half + 3] = _mm256_shuffle_ps::<0xee>(pairs[half + 1], pairs[half + 3]);
    }
    let mut lanes = r;
    for i in 0..WIDTH / 2 {
        lanes[i] = _mm256_permute2f128_ps::<0x20>(fours[i], fours[i + 4]);
        lanes[i + 4] = _mm256_permute2f128_ps::<0x31>(fours[i], fours[i + 4]);
    }
    lanes
}

#[inline]
#[target_feature(enable = "avx2")]
fn between_vectors(low: __m256, high: __m256, fraction: __m256) -> __m256 {
    _mm256_add_ps(low, _mm256_mul_ps(fraction, _mm256_sub_ps(high, low)))
}

#[inline]
#[target_feature(enable = "avx2")]
fn load(numbers: &[f32; WIDTH]) -> __m256 {
    // SAFETY: reads eight f32, which the reference covers; no alignment is asked for.
    unsafe { _mm256_loadu_ps(numbers.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store(numbers: &mut [f32; WIDTH], vector: __m256) {
    // SAFETY: writes eight f32, which the reference covers; no alignment is asked for.
    unsafe { _mm256_storeu_ps(numbers.as_mut_ptr(), vector) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store_at(list: &mut [f32], start: usize, vector: __m256) {
    if let Some(numbers) = list[start..].first_chunk_mut() {
        store(numbers, vector);
    }
}
