// The loop budget: each iteration of a plugin's loop takes one, and a loop that finds none left ends.
//
// The linker puts the check into every loop of a plugin. Half of the 32,768 iterations that an
// invocation may spend go to plugins, the other half to the kernel's own loops.

var<private> loop_budget: u32 = 16384u;

/// 1 where a plugin's loop was ended by the budget.
fn loops_exhausted() -> u32 {
    return select(0u, 1u, loop_budget == 0u);
}
