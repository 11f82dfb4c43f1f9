-- One OpenMPD board: the makers' blocks from the received bytes on, connected as in their top.vhd. The buffer of the USB chip
-- is left out; it only passes bytes on after a second.
library ieee;
use ieee.std_logic_1164.all;

entity board is
    port (
        clock, fast : in std_logic;       -- 50 MHz, and 40.96 MHz from the makers' PLL
        byte_ready : in std_logic;
        byte : in std_logic_vector(7 downto 0);
        sync_in : in std_logic;           -- from the leading board; 0 for a board that leads
        sync_out : out std_logic;
        pins : out std_logic_vector(255 downto 0) := (others => '0')
    );
end entity;

architecture wired of board is
    signal count : std_logic_vector(9 downto 0);
    signal t_en, t_flag, t_pswap, t_aswap, p_enable, a_enable, c_enable, p_swap, a_swap, c_swap : std_logic;
    signal t_data, phase, amplitude : std_logic_vector(6 downto 0);
    signal t_address, address : std_logic_vector(7 downto 0);
    signal color : std_logic_vector(26 downto 0);
    signal data : std_logic_vector(31 downto 0);
    signal shift, latch : std_logic;
begin
    counter : entity work.Counter generic map (10) port map (clock, fast, sync_in, count, open);
    reader : entity work.CommandReader generic map (256) port map (
        clk => clock, byte_in => byte_ready, q_in => byte, divider => open, t_en => t_en, t_flag => t_flag, t_data => t_data,
        t_address => t_address, t_pswap => t_pswap, t_aswap => t_aswap, rgb_data => open, rgb_en => open, debugled => open);
    mapping : entity work.CalibrationAndMapping generic map (0) port map (
        clk => clock, t_en => t_en, t_flag => t_flag, t_data => t_data, t_address => t_address, t_pswap => t_pswap,
        t_aswap => t_aswap, rgb_data => (others => '0'), rgb_en => '0', phase => phase, amplitude => amplitude,
        color => color, address => address, p_enable => p_enable, a_enable => a_enable, c_enable => c_enable,
        p_swap => p_swap, a_swap => a_swap, c_swap => c_swap);
    channels : entity work.AllChannels generic map (256) port map (
        clk => clock, clk_8 => fast, count => count, phase => phase, amplitude => amplitude, color => color,
        address => address, p_enable => p_enable, a_enable => a_enable, c_enable => c_enable, p_swap => p_swap,
        a_swap => a_swap, c_swap => c_swap, data => data, illumi => open, rclk => latch, synccnt => open);
    sync_out <= count(9);

    -- 32 shift registers 74HC595 of eight pins each; the newest bit at a latch is pin 7.
    shift <= not fast;
    registers : for chip in 0 to 31 generate
        signal shifted : std_logic_vector(7 downto 0) := x"00";
    begin
        process (shift) begin
            if rising_edge(shift) then
                shifted <= shifted(6 downto 0) & data(chip);
            end if;
        end process;
        process (latch) begin
            if rising_edge(latch) then
                pins(8 * chip + 7 downto 8 * chip) <= shifted(0) & shifted(1) & shifted(2) & shifted(3)
                    & shifted(4) & shifted(5) & shifted(6) & shifted(7);
            end if;
        end process;
    end generate;
end architecture;
