"""Two motions at one frequency: which starts lead to which."""

from orchestrate import Structure, attractors, basin, plot
from orchestrate.show import figure_files

paper = Structure.nondimensional(e=0.7, D=0.005)
found = attractors(paper, eta=1.32, starts=200, seed=1).isel(eta=0)
print(f"{int(found.number)} attractors, shares {found.share.values.tolist()}")

rare = found.state.sel(attractor=1)  # of the rare one, at phase 0: the plane goes through it
plane = basin(paper, eta=1.32, x=("x_rel", 0.0, 0.8, 40), y=("v_rel", -1.0, 1.0, 40), at=rare)
for number in plane.attractor.values:
    one = plane.sel(attractor=number)
    print(f"{int(one.multiplicity)} T: {float(one.share):.0%} of the plane")
figure_files.save(plot(plane, title="starts around the rare motion"), "basin")  # basin.png
