"""numpy reads the grasps that `robotc grasps` writes as arrays."""

import numpy as np
from conftest import ROOT


def test_numpy_reads_exported_grasps():
    grasps = np.load(ROOT / "crates" / "kb" / "tests" / "golden" / "grasps.npz", allow_pickle=False)
    turned = [[0, -1, 0, 0.1], [1, 0, 0, -0.2], [0, 0, 1, 0.25], [0, 0, 0, 1]]
    assert grasps["transforms"].shape == (2, 4, 4)
    np.testing.assert_allclose(grasps["transforms"][0], turned, atol=1e-12)
    np.testing.assert_array_equal(grasps["confidence"], [1.0, 0.75])
    np.testing.assert_array_equal(grasps["closed"], [[0.125, 0.01], [0.25, 0.01]])
    np.testing.assert_array_equal(grasps["open"], [[0.04, 0.04], [0.04, 0.04]])
    assert list(grasps["joints"]) == ["left", "right_finger"]
    assert (grasps["object"][0], grasps["gripper_link"][0]) == ("größe", "palm")
