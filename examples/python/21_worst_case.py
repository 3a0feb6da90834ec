"""The worst of ten thousand satellites: hub mass, tilt of a boom and the boom's first frequency are
uncertain; the transfer of each is closed from one linear fractional transformation. As
examples/21_worst_case.cpp."""
import numpy as np
import satellite
import titop


def uncertain(boom):
    """Torque of the motor to the turn of the hub."""
    d = titop.Diagram("satellite")
    m, tilt = d.param("m", 85), d.param("tilt", 2.9)
    w1 = d.param("w1", boom.data.omega[0])
    tau_m = d.input("tau_m")
    hub = d.add("hub", titop.RigidBody(**{**satellite.hub_spec, "mass": m}))
    boom1 = d.add("boom1", boom)
    boom2 = d.add("boom2", titop.FlexibleBody(boom, omega={1: w1}))
    hub.parent.force = 0
    titop.mount(boom1, hub.child["C1"], satellite.turn1)
    drive = titop.hinge(d, "drive", boom2, hub.child["C2"], titop.Rotation.about([1, 2, 9], tilt),
                        satellite.hinge_axis)
    drive.torque = satellite.kappa * drive.angle + satellite.c * drive.rate - tau_m
    d.output["turn"] = hub.parent.accel.angular
    return d


system = titop.compile(uncertain(satellite.read_boom()))
f = titop.lft(system, {"m": titop.percent(20), "tilt": titop.between(2.2, 3.6),
                       "w1": titop.percent(10)})
print(f)

random = np.random.RandomState(1).randint(0, 2**32, size=(10000, len(f.deltas)), dtype=np.uint32)
samples = [{d.parameter: d.map.value(2 * (x / 4294967296.0) - 1) for d, x in zip(f.deltas, row)}
           for row in random.tolist()]

print(f"{'rad/s':>10} {'nominal':>12} {'worst':>12}   at")
for omega in 1.0, 10.0, 40.0, 100.0:
    gains = np.linalg.norm(f.transfers(1j * omega, samples), axis=(1, 2))
    nominal = np.linalg.norm(f.transfers(1j * omega, [{}])[0])
    p = samples[gains.argmax()]
    print(f"{omega:10.0f} {nominal:12.4g} {gains.max():12.4g}   "
          f"m = {p['m']:.1f}, tilt = {p['tilt']:.2f}, w1 = {p['w1']:.1f}")
