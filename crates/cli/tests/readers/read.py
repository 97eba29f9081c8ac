"""Reads a trajectory with a program of its own community, `ase`, `gsd` or `ovito`, and prints what that found, as JSON."""

import json
import sys


def with_ase(path):
    import ase.io

    if not path.endswith(".dump"):
        for atoms in ase.io.iread(path, index=":", format="extxyz"):
            arrays = atoms.arrays
            yield {
                "time": float(atoms.info["Time"]),
                "position": atoms.positions.tolist(),
                "velocity": arrays["velo"].tolist(),
                "radius": arrays["radius"].tolist(),
                "mass": arrays["mass"].tolist(),
                "name": arrays["type"].tolist(),
                "box": atoms.cell.lengths().tolist(),
                "periodic": atoms.pbc.tolist(),
            }
        return
    for atoms in ase.io.iread(path, index=":", format="lammps-dump-text"):
        yield {
            "step": int(atoms.info["timestep"]),
            "position": atoms.positions.tolist(),
            "box": atoms.cell.lengths().tolist(),
            "periodic": atoms.pbc.tolist(),
        }


def with_gsd(path):
    import gsd.hoomd

    with gsd.hoomd.open(path) as frames:
        for frame in frames:
            frame.validate()
            particles = frame.particles
            yield {
                "time": float(frame.log["time"][0]),
                "step": int(frame.configuration.step),
                "dimension": int(frame.configuration.dimensions),
                "lower": frame.log["box/lower"].tolist(),
                "position": particles.position.tolist(),
                "velocity": particles.velocity.tolist(),
                "radius": (0.5 * particles.diameter).tolist(),
                "mass": particles.mass.tolist(),
                "name": [particles.types[kind] for kind in particles.typeid],
                "box": frame.configuration.box[:3].tolist(),
            }


def with_ovito(path):
    from ovito.io import import_file

    pipeline = import_file(path)
    for number in range(pipeline.source.num_frames):
        data = pipeline.compute(number)
        particles = data.particles
        names = {kind.id: kind.name or f"type {kind.id}" for kind in particles.particle_types.types}
        found = {
            "position": particles.positions[...].tolist(),
            "velocity": particles.velocities[...].tolist(),
            "mass": particles["Mass"][...].tolist(),
            "name": [names[kind] for kind in particles.particle_types[...].tolist()],
            "box": [float(data.cell[k, k]) for k in range(3)],
            "periodic": [bool(periodic) for periodic in data.cell.pbc],
        }
        if "Time" in data.attributes:
            found["time"] = float(data.attributes["Time"])
        if "Radius" in particles:
            found["radius"] = particles["Radius"][...].tolist()
        yield found


if __name__ == "__main__":
    reader, path = sys.argv[1:]
    frames = {"ase": with_ase, "gsd": with_gsd, "ovito": with_ovito}[reader](path)
    json.dump(list(frames), sys.stdout)
