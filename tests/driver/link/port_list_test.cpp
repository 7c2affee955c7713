// The list of ports, from a made-up sysfs laid out as Linux lays it out.
#include "driver/link/port_list.hpp"

#include "tests/driver/link/scratch_directory.hpp"

#include <gtest/gtest.h>

namespace sweepcast::link {
namespace {

class PortListTest : public testing::Test {
protected:
    struct Adapter {
        std::string bus;  // e.g. "1-1"
        std::string vendor;
        std::string product;
        std::string name;
        std::string serial;
    };

    /// A usb-serial port: class/tty/NAME/device -> .../BUS/BUS:1.0/NAME, two levels below the
    /// adapter.
    void plug_in(const std::string& tty, const Adapter& adapter, const std::string& driver) const {
        const std::filesystem::path usb = std::filesystem::path("sys/devices/usb1") / adapter.bus;
        const auto port = usb / (adapter.bus + ":1.0") / tty;
        scratch_.file(usb / "idVendor", adapter.vendor + "\n");
        scratch_.file(usb / "idProduct", adapter.product + "\n");
        scratch_.file(usb / "product", adapter.name + "\n");
        scratch_.file(usb / "serial", adapter.serial + "\n");
        scratch_.file(port / "tty" / tty / "dev", "188:0\n");
        scratch_.link(port / "driver", scratch_.root() / "sys/bus/usb-serial/drivers" / driver);
        scratch_.link(port / "tty" / tty / "device", "../../../" + tty);
        scratch_.link(
            std::filesystem::path("sys/class/tty") / tty,
            scratch_.root() / port / "tty" / tty
        );
        scratch_.file(std::filesystem::path("dev") / tty, "");
    }

    [[nodiscard]] SystemRoots roots() const {
        return {scratch_.root() / "sys", scratch_.root() / "dev"};
    }
    [[nodiscard]] std::string dev(const std::string& name) const {
        return (scratch_.root() / "dev" / name).string();
    }

    const Adapter cp2102_{"1-1", "10c4", "ea60", "CP2102 USB to UART Bridge Controller", "0001"};
    const Adapter ch340_{"1-2", "1a86", "7523", "USB Serial", ""};
    const Adapter ftdi_{"1-3", "0403", "6001", "FT232R USB UART", "A9"};
    ScratchDirectory scratch_;
};

TEST_F(PortListTest, DescribesAPortWithItsAdapterDriverAndLinks) {
    plug_in("ttyUSB0", cp2102_, "cp210x");
    scratch_.link("dev/serial/by-id/usb-Silicon_Labs_CP2102_0001-if00-port0", "../../ttyUSB0");
    scratch_.link("dev/serial/by-path/pci-0000:00:14.0-usb-0:1:1.0-port0", "../../ttyUSB0");
    SerialPort expected;
    expected.path = dev("ttyUSB0");
    expected.by_id = dev("serial/by-id/usb-Silicon_Labs_CP2102_0001-if00-port0");
    expected.by_path = dev("serial/by-path/pci-0000:00:14.0-usb-0:1:1.0-port0");
    expected.vendor_id = 0x10c4;
    expected.product_id = 0xea60;
    expected.driver = "cp210x";
    expected.product = "CP2102 USB to UART Bridge Controller";
    expected.serial = "0001";
    EXPECT_EQ(list_usb_ports(roots()), std::vector{expected});
}

TEST_F(PortListTest, ListsPortsInOrderAndCandidatesAmongThem) {
    plug_in("ttyUSB2", cp2102_, "cp210x");
    plug_in("ttyUSB0", ftdi_, "ftdi_sio");
    plug_in("ttyUSB1", ch340_, "ch341-uart");
    const auto all = list_usb_ports(roots());
    ASSERT_EQ(all.size(), 3U);
    EXPECT_EQ(all[0].path, dev("ttyUSB0"));
    EXPECT_EQ(all[2].path, dev("ttyUSB2"));
    const auto candidates = list_candidate_ports(roots());
    ASSERT_EQ(candidates.size(), 2U);
    EXPECT_EQ(candidates[0].path, dev("ttyUSB1"));
    EXPECT_EQ(candidates[1].path, dev("ttyUSB2"));
}

TEST_F(PortListTest, FindsTheAdapterOfAPortThatIsItsInterface) {
    // cdc_acm: class/tty/ttyACM0/device is the interface itself.
    scratch_.file("sys/devices/usb1/1-4/idVendor", "1a86\n");
    scratch_.file("sys/devices/usb1/1-4/idProduct", "55d4\n");
    scratch_.file("sys/devices/usb1/1-4/1-4:1.0/tty/ttyACM0/dev", "166:0\n");
    scratch_.link("sys/devices/usb1/1-4/1-4:1.0/tty/ttyACM0/device", "../../../1-4:1.0");
    scratch_.link("sys/class/tty/ttyACM0", "../../devices/usb1/1-4/1-4:1.0/tty/ttyACM0");
    scratch_.file("dev/ttyACM0", "");
    const auto ports = list_candidate_ports(roots());
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_EQ(ports[0].product_id, 0x55d4);
    EXPECT_EQ(ports[0].driver, "");
}

TEST_F(PortListTest, LeavesOutTerminalsWithoutAUsbAdapter) {
    scratch_.file("sys/devices/virtual/tty/tty0/dev", "4:0\n");
    scratch_.link("sys/class/tty/tty0", "../../devices/virtual/tty/tty0");
    scratch_.file("dev/tty0", "");
    EXPECT_TRUE(list_usb_ports(roots()).empty());
}

TEST_F(PortListTest, LeavesOutPortsWithoutADeviceFile) {
    plug_in("ttyUSB0", cp2102_, "cp210x");
    std::filesystem::remove(dev("ttyUSB0"));
    EXPECT_TRUE(list_usb_ports(roots()).empty());
}

TEST_F(PortListTest, LeavesOutAdaptersWithNonsenseForAnId) {
    for (const std::string nonsense : {"", "xyz", "10c4ea60", "10c4 "}) {
        plug_in("ttyUSB0", {"1-1", nonsense, "ea60", "", ""}, "cp210x");
        EXPECT_EQ(list_usb_ports(roots()).size(), nonsense == "10c4 " ? 1U : 0U) << nonsense;
        std::filesystem::remove_all(scratch_.root() / "sys");
    }
}

TEST_F(PortListTest, MakesTextsOfAnAdapterPrintable) {
    plug_in(
        "ttyUSB0",
        {"1-1", "10c4", "ea60", "\x1b[31mred\x07 \xff", std::string(5000, 'x')},
        "cp210x"
    );
    const auto ports = list_usb_ports(roots());
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_EQ(ports[0].product, "\\u001b[31mred\\u0007 \\xff");
    EXPECT_EQ(ports[0].serial, std::string(255, 'x'));
}

TEST_F(PortListTest, IsEmptyWithoutSysfs) {
    EXPECT_TRUE(list_usb_ports({"/nowhere", "/nowhere"}).empty());
}

TEST(LidarAdapter, IsToldByItsUsbIds) {
    EXPECT_TRUE(is_lidar_adapter(0x10c4, 0xea60));
    EXPECT_TRUE(is_lidar_adapter(0x1a86, 0x7523));
    EXPECT_FALSE(is_lidar_adapter(0x1a86, 0xea60));
    EXPECT_FALSE(is_lidar_adapter(0x0403, 0x6001));
}

}  // namespace
}  // namespace sweepcast::link
