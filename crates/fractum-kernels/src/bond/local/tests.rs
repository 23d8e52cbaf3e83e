use proptest::prelude::*;

use super::*;

/// An interface that softens in tension and shear.
fn law() -> LocalBond {
    LocalBond {
        tensile_strength: 3e5,
        shear_strength: 5e5,
        internal_friction: 0.3,
        friction: 0.4,
        softening: [0.2, 0.1],
        ..LocalBond::elastic(1e9, 0.25)
    }
}

proptest! {
    #[test]
    fn interfaces_side_by_side_whose_damage_stays_have_the_bits_of_each_by_itself(
        normal in prop::array::uniform4(-0.02f64..2e-4), shear in prop::array::uniform12(-1e-3f64..1e-3),
        slip in prop::array::uniform12(-1e-3f64..1e-3), last in prop::array::uniform12(-1e-3f64..1e-3),
        crushed in prop::array::uniform4(-0.02f64..0.02), coupled in prop::bool::ANY,
    ) {
        let failure = if coupled { InterfaceFailure::Coupled } else { InterfaceFailure::Uncoupled };
        let crushing = Crushing { stress: [2e6, 5e6, 9e6], ratio: [2.0, 4.0, 9.0] };
        let law = LocalBond { crushing, failure, ..law() };
        let vector = |of: &[f64; 12]| [0, 1, 2].map(|a| Lanes::<4>::of(|k| of[3 * k + a]));
        let own = |of: &[f64; 12], k: usize| [of[3 * k], of[3 * k + 1], of[3 * k + 2]];
        let mut memory: [InterfaceMemory; 4] = std::array::from_fn(|k| InterfaceMemory {
            crushed: if crushed[k] > 0.002 { crushed[k] } else { 0.0 },
            damage: [if k % 2 == 0 { 1.0 } else { 0.0 }; 2],
            last: [crushed[k] - 0.01, 0.0, 0.0, 0.0],
            dissipated: 3.0,
            ..InterfaceMemory::default()
        });
        let before = memory;
        let mut past = steady::Past { slip: vector(&slip), shear: vector(&last) };
        let (mut stress, mut across) = (Lanes::splat(0.0), [Lanes::splat(0.0); 3]);
        let strains = (Lanes(normal), vector(&shear));
        let [kept, moved] = law.steady(0b1111, strains, &mut past, &mut memory, (&mut stress, &mut across));
        prop_assert_eq!(kept & 0b0101, 0b0101);
        for k in (0..4).filter(|k| kept >> k & 1 == 1) {
            let mut alone = before[k];
            let (pull, held, slipped) = law.stress(normal[k], own(&shear, k), [own(&slip, k), own(&last, k)], &mut alone);
            prop_assert_eq!((pull, held), (stress.0[k], across.map(|a| a.0[k])));
            prop_assert_eq!((slipped, alone), (past.slip.map(|a| a.0[k]), memory[k]));
            prop_assert_eq!(slipped != own(&slip, k), moved >> k & 1 == 1);
        }
    }
}

#[test]
fn impossible_numbers_are_refused() {
    let fine = law();
    for wrong in [
        LocalBond { young_modulus: 0.0, ..fine },
        LocalBond { poisson_ratio: 0.6, ..fine },
        LocalBond { tensile_strength: -1.0, ..fine },
        LocalBond { softening: [0.0, 1.0], ..fine },
        LocalBond { crushing: Crushing { stress: [2.0, 1.0, 3.0], ratio: [1.0; 3] }, ..fine },
        LocalBond { crushing: Crushing { stress: [1.0, 2.0, 3.0], ratio: [0.5; 3] }, ..fine },
    ] {
        assert!(wrong.check().is_err(), "{wrong:?}");
    }
}
