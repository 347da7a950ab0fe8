"""A motor of limited power drives a beam through its resonance: where the speed jumps."""

from orchestrate import Drive, Structure, couple

beam = Structure(m1=1.5, m2=1.5, k1=8437.5, k2=10125.0, d1=4.5, d2=4.5, e=0.7)  # SI
motor = Drive(
    box_mass=5.5,  # kg, with the motor
    box_stiffness=309.375,  # N/m
    box_damping=4.125,  # N s/m
    unbalance_mass=0.025,  # kg
    unbalance_radius=0.02,  # m
    rotor_inertia=5e-5,  # kg m2
    motor_constant=0.06,  # N m/A
    armature_resistance=12.0,  # Ohm
)
for name, structure in {"bonded": beam.as_bonded(), "delaminated": beam}.items():
    run = couple(structure, motor, voltage=(5.8, 6.6), rate=0.05, settle=1.0)  # V, V/s, s
    up, down = run.jumps.sel(jump=["up", "down"]).values
    print(f"{name:11}: the speed jumps at {up:.2f} V on the way up, {down:.2f} V on the way down")
