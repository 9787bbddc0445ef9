"""What the overlay's packages are to others: messages, names, folders."""

import os
import re
import subprocess
from pathlib import Path

import pytest
from tests.ros1.conftest import PYTHON

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "ros1" / "src"
PACKAGES = sorted(path.name for path in SOURCE.iterdir() if (path / "package.xml").is_file())

# What Debian's and Noetic's rosmsg and rossrv print for gazebo_msgs 2.9.2.
MD5 = """
msg ContactState 48c0ffb054b8c444f870cecea1ee50d9
msg ContactsState acbcb1601a8e525bf72509f18e6f668d
msg LinkState 0818ebbf28ce3a08d48ab1eaa7309ebe
msg LinkStates 48c080191eb15c41858319b4d8a609c2
msg ModelState 9330fd35f2fcd82d457e54bd54e10593
msg ModelStates 48c080191eb15c41858319b4d8a609c2
msg ODEJointProperties 1b744c32a920af979f53afe2f9c3511f
msg ODEPhysics 667d56ddbd547918c32d1934503dc335
msg PerformanceMetrics 884f71fd5037b886ec5e126b83c4425a
msg SensorPerformanceMetric 01762ded18cfe9ebc7c8222667c99547
msg WorldState de1a9de3ab7ba97ac0e9ec01a4eb481e
srv ApplyBodyWrench 585b9f9618aa0581b207e2f2d90866bc
srv ApplyJointEffort c0039811b8cc919490b3cff748cdf46b
srv BodyRequest 5eade9afe7f232d78005bd0cafeab755
srv DeleteLight ae11ea8100d536d5b92c2b5917abf912
srv DeleteModel 9ce56b4e9e54616de25d796dc972a262
srv GetJointProperties 7b30be900f50aa21efec4a0ec92d91c9
srv GetLightProperties df2cef87e13e2e6990e81e8aaa454c19
srv GetLinkProperties 0e06a70386d0ee3fb880c02f23fcd821
srv GetLinkState 09d6c98cce97b35f7ab9bd70300657ab
srv GetModelProperties 5717f7bd34ed990fa80e28b3015027a3
srv GetModelState 4c515e936d3319c9610c559c60bfc3d4
srv GetPhysicsProperties 575a5e74786981b7df2e3afc567693a6
srv GetWorldProperties 36bb0f2eccf4d8be971410c22818ba3f
srv JointRequest 0be1351618e1dc030eb7959d9a4902de
srv SetJointProperties 15a76e921b1410c698d82782ea5fa370
srv SetJointTrajectory 88f5c10979e3f9649d5ae87a3b12aa65
srv SetLightProperties e6f13430c57278bb364aca53a1bf5ebf
srv SetLinkProperties d534ce1b36ee99de0ffa806c3a6348f0
srv SetLinkState 8a5146eb66ae4d26b0860b08f3f271be
srv SetModelConfiguration 10e3139d3b669c40afc057d38956fff7
srv SetModelState 5b3ab0281d4f5445def017e3a2e4a07b
srv SetPhysicsProperties 97e2057080558ce4730434b5fae75c91
srv SpawnModel 9ed9c82c96abe1a00c3e8cdaeee24413
"""

SUMS = """
import gazebo_msgs.msg, gazebo_msgs.srv
for kind, module in ("msg", gazebo_msgs.msg), ("srv", gazebo_msgs.srv):
    for name in sorted(vars(module)):
        one = getattr(module, name)
        if isinstance(one, type) and not name.endswith(("Request", "Response")):
            print(kind, name, one._md5sum)
        elif name in ("BodyRequest", "JointRequest"):
            print(kind, name, one._md5sum)
"""


def test_messages_have_the_sums_that_others_expect(ros):
    process = ros.python(SUMS)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    assert output.split() == MD5.split()


def test_rosmsg_and_rossrv_know_them(ros):
    assert ros.run("rosmsg", "md5", "gazebo_msgs/LinkState").stdout.split() == [
        "0818ebbf28ce3a08d48ab1eaa7309ebe"
    ]
    assert ros.run("rossrv", "md5", "gazebo_msgs/SpawnModel").stdout.split() == [
        "9ed9c82c96abe1a00c3e8cdaeee24413"
    ]


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_are_found(ros, package):
    tool = "rosstack" if package == "gazebo_ros_pkgs" else "rospack"
    found = ros.run(tool, "find", package).stdout.strip()
    assert Path(found).resolve() == (SOURCE / package).resolve()


def test_roscd_goes_to_the_tutorials_folder(overlay):
    command = "source ros1/devel/setup.bash && roscd rosbots_description/launch && ls"
    shell = subprocess.run(
        ["bash", "-c", command], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert {"object.urdf", "rviz.launch", "spawn.launch"} <= set(shell.stdout.split())


def test_links_are_relative_and_lead_somewhere_within_the_repository():
    links = [
        path for path in SOURCE.rglob("*") if path.is_symlink() and path.name != "CMakeLists.txt"
    ]
    assert len(links) >= 4
    for link in links:
        assert not link.readlink().is_absolute(), link
        assert link.exists(), link
        assert link.resolve().is_relative_to(ROOT), link


def test_the_program_that_is_missing_is_named(ros):
    environment = {"PATH": "/usr/bin:/bin", "CARTWHEEL": ""}
    program = (ros.overlay.program("gazebo_ros", "gzserver")).read_text()
    lost = ros.folder / "gzserver"
    built_with = re.search(r"/[^\" ]*/cartwheel", program)[0]
    assert Path(built_with).is_file()
    lost.write_text(program.replace(built_with, "/nowhere/cartwheel"))
    done = ros.run("sh", lost, status=127, environment=environment)
    assert "/nowhere/cartwheel" in done.stderr
    assert "CARTWHEEL=" in done.stderr
    chosen = ros.run("sh", lost, "--version", environment={"CARTWHEEL": built_with})
    assert chosen.stdout.startswith("cartwheel ")


def test_a_launcher_starts_python_unless_rospy_reads_something_when_it_is_imported(ros):
    def parent(*words, **environment):
        code = "import os; print(os.getppid())"
        done = ros.run(PYTHON, "-c", code, *words, environment=environment)
        return int(done.stdout)

    assert parent() == parent() != os.getpid()
    assert parent("a:=b") == parent(ROS_NAMESPACE="left") == os.getpid()
