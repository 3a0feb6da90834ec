"""No more states than the scene needs: inputs are a wheel on the satellite's hub and the motor of
the hinge, outputs the motion of the hub and of one tip, up to 100 Hz, to one part in a thousand.
As examples/14_reduction.cpp."""
import satellite
import titop

d = satellite.satellite(satellite.beam())
scene = titop.Scene(inputs=["W(6)", "tau_m"], outputs=["hub(4)", "hub(5)", "hub(6)", "tip2", "theta"],
                    band_hz=[0, 100], accuracy=1e-3)
r = titop.compile(d, scene)
print(f"{d.name}: {r.order} states instead of {r.full.order}")
for step in r.steps:
    print(f"  {step.name}: {step.before} -> {step.after} coordinates, "
          f"{'exact' if step.error == 0 else step.text}")
print(f"bound below 1e-3: {'yes' if r.bound.worst <= scene.accuracy else 'NO'}")

print("\nkept modes below 120 Hz")
for mode in r.modes:
    if mode.hertz < 120:
        print(f"  {mode.hertz:8.3f} Hz ", *(f"{name} {100 * share:.0f} %" for name, share in mode.blocks))

print("\naccuracy  states")
for w in titop.what_if(d, scene, [1e-1, 1e-2, 1e-3, 1e-4, 1e-5]):
    print(f"{w.accuracy:8.0e}  {w.order:6}")

# Its inputs and outputs are the full system's: one can replace the other.
m = r.second_order()
print(f"\nM, D, K: {len(m.K)} x {len(m.K.T)}; modal: {len(r.modal().A)} blocks of 2 x 2; dense: "
      f"{r.state_space().order} states")
