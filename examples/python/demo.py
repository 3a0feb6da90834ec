"""A satellite from real finite-element data, compiled to one state-space model, drawn and reported;
then the hub's attitude is controlled. As examples/demo.cpp, which also compares it with M and K
assembled by hand."""
import shutil

import numpy as np
import satellite
import titop

boom = satellite.read_boom()
hertz = " ".join(f"{omega / (2 * np.pi):.5f}" for omega in boom.data.omega[:3])
print(f"boom: {boom.data.D_P[0, 0]:.4g} kg, {len(boom.data.omega)} modes and residual vectors, "
      f"first three [Hz] {hertz}\n")

system = titop.compile(satellite.satellite(boom))
model = system.state_space()
print(system.log() + system.dense_log(), end="")
print(f"\nmodel: {model.order} states, {len(model.inputs)} inputs, {len(model.outputs)} outputs; "
      f"poles\n{system.poles()}", end="")

certificate = system.dense_certificate()
print("\ncertificate (numbers in certificate.txt)")
for text, error, bound in (("every equation as written", certificate.residual, 1e-11),
                           ("dense model against the factors", certificate.dense_against_factors,
                            1e-12)):
    print(f"  {text}: to {bound:.0e} {'yes' if error <= bound else 'NO'}")

kp, kd = 40, 40
held = titop.compile(satellite.satellite(boom, (kp, kd)))
print(f"\nattitude held by {kp} N m/rad and {kd} N m s/rad on the hub: order "
      f"{held.state_space().order}, slowest poles\n{held.poles()[:5]}", end="")

with open("certificate.txt", "w") as file:
    file.write(str(certificate))
with open("satellite.dot", "w") as file:
    file.write(titop.to_dot(system))
titop.plot_bode(system, "hub(3)", "W(3)").write("bode.svg")
titop.plot_mode(system, 1).write("mode.svg")
page = titop.report(system, title="Satellite with two booms", diagrams=bool(shutil.which("dot")))
page.write("report.html")
