"""Changes of descriptions that are applied to the compiled model, without a compilation.

The compiled model then has the values that a compilation of the changed descriptions gives, in each
array that the physics uses. ``tests/simulation/test_in_place.py`` compares both.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np

from cartwheel.description.model import Joint, Link, RobotDescription, Surface
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.differences import differ_in_place
from cartwheel.simulation.models.placement import put_fixed
from cartwheel.simulation.models.waking import wake_all
from cartwheel.world import (
    Build,
    Principal,
    drag_chains,
    exclude_rotors,
    extend_at_rest,
    principal_inertial,
    rotor_strength,
    stiffen_rotors,
)
from cartwheel.world.additions import Added
from cartwheel.world.contact import BuiltSurface, friction, reference
from cartwheel.world.contact_rules import ContactRules, contact_rules
from cartwheel.world.entry import ROTOR, ModelEntry, Motor, collision_of, scoped
from cartwheel.world.joints import axes_of, friction_of, limits_of
from cartwheel.world.mimics import limited_followers
from cartwheel.world.pairs import Pair
from cartwheel.world.visuals import plain_colour

_OBJ = mujoco.mjtObj
_SLEEP = mujoco.mjtEnableBit.mjENBL_SLEEP.value
_HINGE = mujoco.mjtJoint.mjJNT_HINGE


class InPlace:
    """Applies changed descriptions and poses to the model of an engine.

    Args:
        engine: The engine.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._surfaces: tuple[BuiltSurface, ...] = ()
        self._joined: frozenset[frozenset[str]] = frozenset()
        self._rules: ContactRules | None = None
        """The contact parameters of the model; None until they are first needed."""
        self._entries: Sequence[ModelEntry] = ()
        self._scratch: Any = None
        self._recompiles_visuals = False

    def bind(self, built: Build, entries: Sequence[ModelEntry]) -> None:
        """Continues with a newly compiled model.

        Args:
            built: The model.
            entries: The models in it.
        """
        self._surfaces, self._joined, self._rules = built.surfaces, built.joined, None
        self._entries, self._scratch = entries, None

    def recompiles_visuals(self) -> bool:
        """Whether visuals were changed since the last call that only a compilation can change."""
        needed, self._recompiles_visuals = self._recompiles_visuals, False
        return needed

    # -- properties

    def describe(self, entry: ModelEntry, before: RobotDescription) -> list[Added] | None:
        """Applies the changes of a model's description.

        Args:
            entry: The model with its new description.
            before: The description with which the model was compiled.

        Returns:
            What is added to the new description, of what depends on the changes; None if only a
            compilation can apply them, and nothing has changed.
        """
        after = entry.description
        if not differ_in_place(before, after):
            return None
        if limited_followers(entry, before) != limited_followers(entry, after):
            # Their constraints are written differently.
            return None
        model, name = self._engine.model, entry.name
        links = [pair for pair in zip(before.links, after.links, strict=True) if _differ(*pair)]
        heavier = [(old, new) for old, new in links if old.inertial != new.inertial]
        inertials: list[tuple[int, Principal, Link, float | None]] = []
        for old, link in heavier:
            if link.inertial is None:
                return None
            body = self._engine.body_id(name, link.name)
            if (values := self._reweighed(body, old, link)) is not None:
                inertials.append((body, values, link, None))
                continue
            moves = bool(model.body_treeid[body] >= 0)
            raises = not moves or "minimum-inertia" not in self._engine.without
            try:
                values, raised = principal_inertial(link.inertial, raises=raises)
            except ValueError:
                # The compilation reports it.
                return None
            if model.body_simple[body]:
                values = values.along_body()
                if not values.at_body:
                    # The structure of the mass matrix changes.
                    return None
            inertials.append((body, values, link, raised if moves else None))
        rules = self._changed_rules(entry, links, mass=before.mass != after.mass)
        if rules is None:
            return None
        added: list[Added] = []
        for body, values, link, raised in inertials:
            model.body_mass[body], model.body_inertia[body] = values.mass, values.moments
            model.body_ipos[body], model.body_iquat[body] = values.position, values.orientation
            if raised is not None and link.inertial is not None:
                added.append(
                    Added(
                        addition="minimum-inertia",
                        model=name,
                        element=link.name,
                        value=raised,
                        origin=link.inertial.origin,
                    )
                )
        for old, new in links:
            if old.gravity != new.gravity:
                model.body_gravcomp[self._engine.body_id(name, new.name)] = float(not new.gravity)
                model.flg_gravcomp = bool(model.body_gravcomp.any())
        self._paint(entry, links)
        damped = False
        for old_joint, new_joint in zip(before.joints, after.joints, strict=True):
            if old_joint is not new_joint and old_joint != new_joint:
                damped = True
                self._set_joint(entry, new_joint)
        if rules is not self._rules:
            self._set_rules(rules)
            added += rules.added
        if inertials or damped:
            added += self._settle(weighs=bool(inertials))
        self.wake()
        return added

    def _reweighed(self, body: int, old: Link, new: Link) -> Principal | None:
        """The inertial of a body whose mass alone has changed; None if more has changed."""
        before, after = old.inertial, new.inertial
        if before is None or after is None or replace(after, mass=before.mass) != before:
            return None
        if not any((*after.diagonal, *after.products)):
            # The inertia of a point mass depends on its mass.
            return None
        model = self._engine.model
        return Principal(
            mass=after.mass,
            position=model.body_ipos[body].copy(),
            orientation=model.body_iquat[body].copy(),
            moments=model.body_inertia[body].copy(),
        )

    def _paint(self, entry: ModelEntry, links: Iterable[tuple[Link, Link]]) -> None:
        for old, new in links:
            if old.visuals == new.visuals:
                continue
            colour = plain_colour(new.visuals)
            if colour is None:
                self._recompiles_visuals = True
            else:
                self._engine.visuals.paint(scoped(entry.name, new.name), colour)

    def _set_joint(self, entry: ModelEntry, joint: Joint) -> None:
        model = self._engine.model
        if entry.description.static:
            return
        for suffix, axis in axes_of(joint):
            index = self._engine.joint_id(entry.name, f"{joint.name}{suffix}")
            if index < 0:
                # It closes a loop.
                continue
            dof = int(model.jnt_dofadr[index])
            model.dof_damping[dof] = axis.damping
            model.dof_frictionloss[dof] = friction_of(entry, joint, axis)
            model.jnt_stiffness[index] = axis.spring_stiffness
            springs = bool(axis.spring_stiffness)
            model.qpos_spring[model.jnt_qposadr[index]] = axis.spring_reference if springs else 0.0
            bounds = limits_of(joint, axis, follows=joint.name in entry.mimics)
            model.jnt_limited[index] = bounds is not None
            model.jnt_range[index] = bounds or (0.0, 0.0)
            most = axis.effort or 0.0
            model.jnt_actfrclimited[index] = most > 0
            model.jnt_actfrcrange[index] = (-most, most) if most > 0 else (0.0, 0.0)
        motor = entry.motors.get(joint.name)
        if motor is not None:
            self._set_motor(entry.name, motor, joint)

    def _set_motor(self, name: str, motor: Motor, joint: Joint) -> None:
        """Limits the effort of a motor; `ServoHandle.strengthen` continues with its command."""
        model = self._engine.model
        actuator = mujoco.mj_name2id(model, _OBJ.mjOBJ_ACTUATOR, scoped(name, joint.name))
        most = motor.max_effort
        if actuator >= 0:
            model.actuator_forcelimited[actuator] = most is not None
            model.actuator_forcerange[actuator] = (0.0, 0.0) if most is None else (-most, most)
        if motor.mode == "velocity":
            rotor = mujoco.mj_name2id(model, _OBJ.mjOBJ_TENDON, scoped(name, joint.name, ROTOR))
            model.tendon_frictionloss[rotor] = rotor_strength(motor, joint)

    def _settle(self, *, weighs: bool) -> list[Added]:
        """Computes the constants that depend on masses and damping."""
        model = self._engine.model
        if weighs:
            if self._scratch is None:
                self._scratch = mujoco.MjData(model)
            mujoco.mj_resetData(model, self._scratch)
            mujoco.mj_setConst(model, self._scratch)
            exclude_rotors(model)
            extend_at_rest(model)
            stiffen_rotors(model)
        return self.drag()

    def drag(self) -> list[Added]:
        """Computes the drag of chains, which depends on masses, damping and gravity."""
        model = self._engine.model
        if "chain-drag" in self._engine.without or not (model.jnt_type == _HINGE).any():
            return []
        return [found for _, found in drag_chains(model, self._entries) if found.element]

    # -- contacts

    def _changed_rules(
        self, entry: ModelEntry, links: Sequence[tuple[Link, Link]], *, mass: bool
    ) -> ContactRules | None:
        """The contact parameters with the links' surfaces; None if the pairs are others."""
        changed = {
            scoped(entry.name, new.name, collision.name): collision.surface
            for old, new in links
            for before, collision in zip(old.collisions, new.collisions, strict=True)
            if before.surface != collision.surface
        }
        rules = self._rules
        if rules is None:
            rules = self._rules = self._rules_of(self._surfaces)
        if not changed and not mass:
            return rules
        surfaces = tuple(
            self._resurfaced(each, entry, changed.get(collision_of(each.name), each.surface))
            if each.model == entry.name
            else each
            for each in self._surfaces
        )
        if surfaces == self._surfaces:
            return rules
        found = self._rules_of(surfaces)
        if [_geoms(pair) for pair in found.pairs] != [_geoms(pair) for pair in rules.pairs]:
            return None
        self._surfaces = surfaces
        return found

    def _rules_of(self, surfaces: Sequence[BuiltSurface]) -> ContactRules:
        return contact_rules(surfaces, self._joined, self._engine.without)

    def _resurfaced(
        self, surface: BuiltSurface, entry: ModelEntry, stated: Surface
    ) -> BuiltSurface:
        step = float(self._engine.model.opt.timestep)
        return replace(
            surface,
            surface=stated,
            friction=friction(stated),
            reference=reference(stated, entry.description.mass, step),
        )

    def _set_rules(self, rules: ContactRules) -> None:
        before, self._rules = self._rules, rules
        assert before is not None
        model = self._engine.model
        for old, surface, priority in zip(
            before.surfaces, rules.surfaces, rules.priorities, strict=True
        ):
            geom = model.geom(surface.name).id
            model.geom_priority[geom] = priority
            if old is not surface:
                model.geom_friction[geom] = surface.friction
                model.geom_solref[geom] = surface.reference
        numbers = {
            frozenset(pair): number
            for number, pair in enumerate(
                zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)
            )
        }
        for was, pair in zip(before.pairs, rules.pairs, strict=True):
            if was == pair:
                continue
            arguments = pair.arguments()
            geoms = frozenset(model.geom(arguments[f"geomname{side}"]).id for side in (1, 2))
            number = numbers[geoms]
            model.pair_dim[number] = arguments["condim"]
            model.pair_friction[number] = arguments["friction"]
            model.pair_solref[number] = arguments["solref"]
            model.pair_solimp[number] = arguments["solimp"]
            model.pair_solreffriction[number] = arguments.get("solreffriction", (0.0, 0.0))
        if rules.alignments != before.alignments:
            self._engine.align(rules.alignments)

    # -- poses

    def place(self, entry: ModelEntry, joined: Iterable[Joint]) -> bool:
        """Moves the links that are fixed to the world to the entry's pose.

        Args:
            entry: The model with its new pose.
            joined: Joints between different models.

        Returns:
            Whether it was done. Otherwise, only a compilation can do it, and nothing has changed.
        """
        prefix = scoped(entry.name, "")
        if any(name.startswith(prefix) for each in joined for name in (each.parent, each.child)):
            return False
        model = self._engine.model
        moved = put_fixed(self._engine, entry)
        rooted = np.isin(model.body_rootid, moved)
        if model.neq or bool(model.body_dofnum[rooted].any()):
            self._settle(weighs=True)
        self.locate_fixed()
        self.wake()
        return True

    def locate_fixed(self) -> None:
        """Computes the places of fixed links, which the engine otherwise computes only once."""
        model, data = self._engine.model, self._engine.data
        sleeps = model.opt.enableflags & _SLEEP
        model.opt.enableflags &= ~_SLEEP
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        model.opt.enableflags |= sleeps

    def wake(self, *, changes_model: bool = True) -> None:
        """Wakes all bodies, because what keeps them at rest may have changed.

        Args:
            changes_model: Whether more than the places of models has changed.
        """
        wake_all(self._engine)
        self._engine.revisions += changes_model
        self._engine.note_change()


def _geoms(pair: Pair) -> tuple[str, str]:
    return pair.first.name, pair.second.name


def _differ(one: Link, two: Link) -> bool:
    return one is not two and one != two
