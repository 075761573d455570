"""Joints of pantographs in a time step: friction and stops as bounded forces between two parts."""

from pantocheck.model.dynamics.contact_arrays import ContactWorkspace
from pantocheck.model.dynamics.kernel_compilation import kernel
from pantocheck.model.dynamics.scalar_forces import NEGLIGIBLE_FORCE, maximum
from pantocheck.model.dynamics.train import Train


@kernel
def predict_joints(train: Train, work: ContactWorkspace) -> None:
    """Force of each joint by the predicted motion, without its bounds."""
    for k in range(train.joint_owner.size):
        p, closing, rate = train.joint_owner[k], -train.joint_law[k, 2], 0.0
        for i in range(train.z.shape[2]):
            closing += train.joint[k, i] * train.z[0, p, i]
            rate += train.joint[k, i] * train.z[1, p, i]
        work.joint[k] = train.joint_law[k, 0] * closing + train.joint_law[k, 1] * rate


@kernel
def sweep_joints(train: Train, work: ContactWorkspace) -> float:
    """Solve every joint once, all other forces held; return the largest change of a force [N]."""
    largest = 0.0
    for k in range(train.joint_owner.size):
        p, old, acceleration = train.joint_owner[k], train.joint_force[k], 0.0
        for i in range(train.z.shape[2]):
            acceleration += train.joint[k, i] * train.z[2, p, i]
        force = work.joint[k] + train.joint_gain[k] * acceleration + train.joint_compliance[k] * old
        force = min(max(force / (1 + train.joint_compliance[k]), train.joint_law[k, 3]), train.joint_law[k, 4])
        change = force - old
        if abs(change) > NEGLIGIBLE_FORCE:
            train.joint_force[k] = force
            for i in range(train.z.shape[2]):
                for j in range(train.z.shape[2]):
                    train.z[2, p, i] -= train.inverse[p, i, j] * train.joint[k, j] * change
        largest = maximum(largest, abs(change))
    return largest
