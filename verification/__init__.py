"""Independent methods, references, and where methods fail. For benchmarks and tests.

references         methods of a scene that must agree, and the reference they give; `variants`
runs               measured runs of a scene, their headline signal and its errors
work_precision     errors of curves, Pareto fronts; `orders`
population         random gears around the default one; `wide_tests`
runge_kutta        the gear by classical Runge-Kutta          } methods
slow_swing         a reversal in the limit of slow motion     } besides
flywheel           the gear by Exudyn's explicit solvers      } those of
faceted            pinions of flat facets                     } `simulate`
equilibria         equilibria under force laws of no fidelity
law_area           the contact law "area", which no user chooses; `area_contact`, `area_pattern`
law_elements       law "teeth" with the compliance of finite elements; `tooth_elements`
sampler            random gears and plans over every declared parameter; `ranges`, `stated_ranges`
plan_reference     the right metrics of any plan, known before it is run; `seat_cells`, `refined_steps`
stick_slip         stick-slip of gear and column, reduced to one inertia, by events and by limits
stability          whether a plan's number is right; bisected limits; `stable_step`
shaping            the pinion as it is cut; `flank_deviation`
"""
